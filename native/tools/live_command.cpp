// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <mutex>
#include <thread>

#include "live/service.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/stop_signal.h"

namespace fourdvt::tools {
namespace {

using live::ServiceOptions, live::ServiceStatus;

const CommandHelp& help() {
  static const CommandHelp text{
      "live RIG.json [options]",
      "Shows a performer before cameras in web pages while he moves: reads the "
      "rig's cameras, or has them sent by fourdvt "
      "live-camera, carves the hull of their outlines and sends it with their "
      "pictures to every page. "
      "<fourdvt-viewer src=\"ws://localhost:8090/live\"> shows it. Ends by "
      "Ctrl-C.",
      {{"--port", "N", "port to listen on, 0: any (default 8090)"},
       {"--listen", "ADDRESS",
        "address to listen on (default 127.0.0.1: this machine alone); any "
        "other needs --certificate, --key and --tokens"},
       {"--certificate", "FILE", "TLS: certificate, PEM"},
       {"--key", "FILE", "TLS: its private key, PEM"},
       {"--tokens", "FILE",
        "who may do what: lines \"camera TOKEN\", \"viewer TOKEN\", \"console "
        "TOKEN\"; made if it is missing"},
       {"--allow-origin", "A,B", "further pages that may connect, such as https://example.org"},
       {"--host", "A,B", "further names of this server"},
       {"--web", "FOLDER",
        "files to serve, such as build/site: the console is its "
        "live/index.html"},
       {"--no-local", nullptr,
        "do not read the rig's own sources: every camera is sent by fourdvt "
        "live-camera"},
       {"--record", "CAPTURE", "write a capture folder beside, for fourdvt reconstruct and bake"},
       {"--tolerance", "PX",
        "outlines are simplified by so many pixels, 0.25 to 64 (default: as "
        "the machine's speed allows)"},
       {"--crf", "N", "quality of the pictures, 0 (best) to 51 (default 23)"},
       {"--picture-share", "X",
        "texels of the picture that pages get, against the cameras' pixels, "
        "0.05 to 1 (default 0.5)"},
       {"--wait-ms", "X",
        "a frame is made so long after its time of what has come (default "
        "100)"}}};
  return text;
}

bool isThisMachine(const std::string& address) { return address.empty() || live::isLoopback(address); }

ServiceOptions readOptions(Args& args, std::string& tokens_file) {
  ServiceOptions o;
  o.server.port = uint16_t(args.integer("--port", 8090, 0, 65535));
  o.server.address = args.text("--listen", o.server.address);
  o.server.certificate_file = args.text("--certificate");
  o.server.key_file = args.text("--key");
  tokens_file = args.text("--tokens");
  o.access.loopback = isThisMachine(o.server.address);
  o.access.origins = args.list("--allow-origin");
  o.access.hosts = args.list("--host");
  o.web_folder = args.text("--web");
  o.local_sources = !args.has("--no-local");
  live::PipelineOptions& p = o.pipeline;
  p.record_folder = args.text("--record");
  if (args.has("--tolerance")) {
    p.least_tolerance_px = p.most_tolerance_px = args.number("--tolerance", 1, 0.25, 64);
    p.controls_tolerance = false;
  }
  p.crf = args.integer("--crf", p.crf, 0, 51);
  p.picture_share = args.number("--picture-share", p.picture_share, 0.05, 1);
  p.wait_s = args.number("--wait-ms", 1000 * p.wait_s, 0, 5000) / 1000;
  if (o.server.certificate_file.empty() != o.server.key_file.empty())
    args.complain("--certificate and --key go together");
  if (!o.access.loopback && (o.server.certificate_file.empty() || tokens_file.empty()))
    args.complain("--listen " + o.server.address +
                  " shows the cameras' pictures to others: it needs "
                  "--certificate FILE, --key FILE and --tokens FILE");
  return o;
}

std::string lineOf(const ServiceStatus& s) {
  double contours = 0, pictures = 0;
  size_t there = 0;
  uint64_t late = 0;
  for (const auto& c : s.pipeline.cameras) {
    contours += c.contour_bytes_per_s, pictures += c.picture_bytes_per_s;
    there += c.connected && !c.lost;
    late += c.late;
  }
  const live::PipelineStatus& p = s.pipeline;
  char text[320];
  std::snprintf(text, sizeof text,
                "%4.1f frames/s  %3.0f ms  %5.0f triangles  tolerance %.1f px  "
                "outlines %3.0f + pictures %4.0f kB/s  "
                "stream %3.0f kB/s  cameras %zu of %zu  viewers %llu  late "
                "%llu  left out %llu",
                p.frames_per_s, p.latency_ms, p.triangles, p.tolerance_px, contours / 1e3, pictures / 1e3,
                (p.surface_bytes_per_s + p.picture_bytes_per_s) / 1e3, there, p.cameras.size(),
                static_cast<unsigned long long>(s.viewers), static_cast<unsigned long long>(late),
                static_cast<unsigned long long>(p.skipped + p.failed));
  return text;
}

// The console's line, rewritten in place on a terminal, and other lines above
// it.
class Console {
 public:
  void status(const std::string& line) {
    const std::lock_guard lock(mutex_);
    std::printf(tty_ ? "\r\033[K%s" : "%s\n", line.c_str());
    std::fflush(stdout);
    shown_ = tty_;
  }
  void warn(const std::string& line) {
    const std::lock_guard lock(mutex_);
    if (shown_) std::fputs("\r\033[K", stdout), std::fflush(stdout);
    std::fprintf(stderr, "fourdvt: %s\n", line.c_str());
  }
  void end() {
    if (shown_) std::fputs("\n", stdout);
  }

 private:
  std::mutex mutex_;
  const bool tty_ = isatty(STDOUT_FILENO) != 0;
  bool shown_ = false;
};

void printAddresses(const ServiceOptions& options, uint16_t port, const std::string& tokens_file) {
  const bool tls = !options.server.certificate_file.empty();
  const std::string host = options.access.loopback        ? "localhost"
                           : options.access.hosts.empty() ? options.server.address
                                                          : options.access.hosts.front();
  const std::string at = "://" + host + ":" + std::to_string(port);
  const std::string token = options.access.tokens.any() ? "#token=" + options.access.tokens.console : "";
  if (!options.web_folder.empty())
    std::printf("console: http%s%s/live/%s\n", tls ? "s" : "", at.c_str(), token.c_str());
  std::printf("viewers: ws%s%s/live%s\n", tls ? "s" : "", at.c_str(),
              options.access.tokens.any() ? ("?token=" + options.access.tokens.viewer).c_str() : "");
  std::printf("cameras: fourdvt live-camera RIG.json --camera NAME --server ws%s%s\n", tls ? "s" : "", at.c_str());
  if (options.access.tokens.any()) std::printf("         with FOURDVT_LIVE_TOKEN of %s\n", tokens_file.c_str());
  std::fflush(stdout);
}

}  // namespace

int liveCommand(int argc, char** argv) {
  Args args(help(), argc, argv);
  std::string tokens_file;
  ServiceOptions options = readOptions(args, tokens_file);
  if (const auto code = helpOrProblem(help(), args)) return *code;
  if (!tokens_file.empty()) {
    auto tokens = live::readTokens(tokens_file);
    if (!tokens.ok()) return fail(tokens.error());
    options.access.tokens = tokens.take();
  }
  const auto rig = live::readRig(args.positional());
  if (!rig.ok()) return fail(rig.error());

  const std::atomic<bool>* stop = listenForStop();
  Console console;
  const auto service =
      live::LiveService::start(rig.value(), options, [&](const std::string& line) { console.warn(line); });
  if (!service.ok()) return fail(service.error());
  printAddresses(options, service.value()->port(), tokens_file);
  auto next = std::chrono::steady_clock::now();
  while (!*stop) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (std::chrono::steady_clock::now() < next) continue;
    next += std::chrono::seconds(1);
    console.status(lineOf(service.value()->status()));
  }
  console.end();
  return kOk;
}

}  // namespace fourdvt::tools
