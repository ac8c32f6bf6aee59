// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <thread>

#include "base/text.h"
#include "live/service.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

using live::LiveOptions, live::LiveStatus;

struct LiveArguments {
  std::string rig_file, token_file;
  LiveOptions options;
};

Options serverOptions(LiveArguments& a) {
  LiveOptions& o = a.options;
  return {
      {"--port N", number(o.server.port, 0, 65535), "port to listen on, 1 to 65535; 0: any (default 8090)"},
      {"--listen ADDRESS", text(o.server.address),
       "address to listen on (default 127.0.0.1: this machine only); others, such as 0.0.0.0, need --certificate, "
       "--key "
       "and --tokens"},
      {"--certificate FILE", text(o.server.certificate_file),
       "PEM of the certificate, followed by those that signed it, for https and wss"},
      {"--key FILE", text(o.server.key_file), "PEM of the certificate's private key, without a password"},
      {"--tokens FILE", text(a.token_file),
       "lines \"camera TOKEN\", \"viewer TOKEN\", \"console TOKEN\": who may send, watch and control; a file that "
       "does not exist is made"},
      {"--allow-origin A,B", list(o.access.origins),
       "sites whose pages may connect besides the server's own, e.g. https://example.org"},
      {"--host A,B", list(o.access.hosts),
       "names of the server besides localhost, when it listens on this machine only"},
      {"--web FOLDER", text(o.web_folder), "files to serve under /, e.g. build/site"},
  };
}

Options pipelineOptions(LiveOptions& o) {
  return {
      {"--record CAPTURE", text(o.pipeline.record_folder), "capture folder to write what the cameras send to"},
      {"--tolerance PX", number(o.tolerance_px, 0.05, 64),
       "by which outlines are simplified, pixels, 0.05 to 64 (default: as the machine keeps up, from 0.5 to 16)"},
      {"--crf N", number(o.pipeline.crf, 0, 51), "quality of the video, 0 (best) to 51 (default 23)"},
      {"--wait-ms X", number(o.pipeline.wait_s, 0, 2000, 1e-3),
       "for cameras that are late, milliseconds, 0 to 2000 (default 100)"},
      {"--no-local", flag(o.reads_sources, false), "do not read the rig's own sources"},
  };
}

void printTokens(const std::string& path, const live::Tokens& tokens) {
  std::printf("%s has been made. Give\n  camera machines  --token %s   (or FOURDVT_LIVE_TOKEN)\n", path.c_str(),
              tokens.camera.c_str());
  std::printf("  viewers          ?token=%s\n  yourself         ?token=%s   (watch, control, see cameras)\n",
              tokens.viewer.c_str(), tokens.console.c_str());
}

void printAddresses(const LiveOptions& options, uint16_t port) {
  const bool is_tls = !options.server.certificate_file.empty();
  const std::string& address = options.server.address;
  const bool is_any = address == "0.0.0.0" || address == "::";
  const std::string host = live::isLoopback(address) ? "localhost" : is_any ? "THIS-MACHINE" : address;
  const std::string place =
      (host.find(':') == std::string::npos ? host : "[" + host + "]") + ":" + std::to_string(port);
  if (!options.web_folder.empty()) std::printf("pages:   %s://%s/\n", is_tls ? "https" : "http", place.c_str());
  std::printf("cameras: fourdvt live-camera RIG.json CAMERA --server %s://%s\n", is_tls ? "wss" : "ws", place.c_str());
  std::fflush(stdout);
}

std::string statusLine(const LiveStatus& status) {
  const live::PipelineStatus& p = status.pipeline;
  double contours = 0, pictures = 0;
  int there = 0, lost = 0;
  uint64_t late = 0;
  for (const auto& camera : p.cameras) {
    contours += camera.contour_bytes_per_s;
    pictures += camera.picture_bytes_per_s;
    there += camera.connected && !camera.lost;
    lost += camera.connected && camera.lost;
    late += camera.late;
  }
  return printed(
      "%.1f frames/s  %.0f ms  %.0f triangles  %.2f px  contours %.0f kB/s  pictures %.0f kB/s  stream %.0f "
      "kB/s  cameras %d of %zu%s  viewers %llu  late %llu  skipped %llu",
      p.frames_per_s, p.latency_ms, p.triangles, p.tolerance_px, contours / 1e3, pictures / 1e3,
      (p.surface_bytes_per_s + p.picture_bytes_per_s) / 1e3, there, p.cameras.size(),
      lost > 0 ? (" (" + std::to_string(lost) + " lost)").c_str() : "",
      static_cast<unsigned long long>(status.viewers.viewers), static_cast<unsigned long long>(late),
      static_cast<unsigned long long>(p.skipped + status.viewers.frames_skipped));
}

}  // namespace

Result<int> liveCommand(int argc, char** argv) {
  LiveArguments a;
  a.options.server.port = 8090;
  Args args({"live RIG.json [options]",
             "Makes 4D video while it is filmed: takes outlines and pictures from the rig's cameras, makes a surface "
             "of every instant, and sends it to the pages that watch. Cameras that have a source in RIG.json are read "
             "by this command; others come from fourdvt live-camera on any machine. Ends by Ctrl-C.",
             {&a.rig_file},
             join({serverOptions(a), pipelineOptions(a.options)})},
            argc, argv);
  if (a.options.server.certificate_file.empty() != a.options.server.key_file.empty())
    args.complain("--certificate and --key go together");
  if (const auto code = args.helpOrProblem()) return *code;

  const std::atomic<bool>* stop = listenForStop();
  FOURDVT_ASSIGN(const auto rig, live::readRig(a.rig_file));
  if (!a.token_file.empty()) {
    FOURDVT_ASSIGN(const auto read, live::readOrMakeTokens(a.token_file));
    a.options.access.tokens = read.tokens;
    if (read.made) printTokens(a.token_file, read.tokens);
  }
  LiveLine line;
  FOURDVT_ASSIGN(const auto service,
                 live::LiveService::start(rig, a.options, [&](const std::string& text) { line.note(text); }));
  printAddresses(a.options, service->port());
  for (int tenths = 1; !*stop; ++tenths) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (tenths % 10 == 0) line.show(statusLine(service->status()));
  }
  line.end();
  return kOk;
}

}  // namespace fourdvt::tools
