// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/video.h"

#include "base/text.h"
#include "platform/files.h"
#include "platform/video_writer.h"

namespace fourdvt::studio {
namespace {

constexpr int kCrf = 10;

class Video final : public PictureFile {
 public:
  explicit Video(std::unique_ptr<platform::VideoWriter> writer) : writer_(std::move(writer)) {}
  Status write(const Image& picture) override { return writer_->write(picture); }
  Status finish() override { return writer_->finish(); }

 private:
  const std::unique_ptr<platform::VideoWriter> writer_;
};

class Numbered final : public PictureFile {
 public:
  explicit Numbered(const std::string& folder) : folder_(folder) {}
  Status write(const Image& picture) override {
    const std::string name = printed("/%06u.png", next_++);
    return platform::writeImage(folder_ + name, picture);
  }
  Status finish() override { return {}; }

 private:
  const std::string folder_;
  uint32_t next_ = 0;
};

Result<std::unique_ptr<PictureFile>> makeNumbered(const std::string& folder) {
  FOURDVT_TRY(platform::makeFolder(folder));
  return std::unique_ptr<PictureFile>(std::make_unique<Numbered>(folder));
}

}  // namespace

Result<std::unique_ptr<PictureFile>> PictureFile::create(const std::string& stem, const PictureFormat& format) {
  if (format.images) return makeNumbered(stem);
  auto writer =
      platform::VideoWriter::create(stem + (format.channels == 3 ? ".mp4" : ".mkv"), {.width = format.width,
                                                                                      .height = format.height,
                                                                                      .channels = format.channels,
                                                                                      .fps = format.fps,
                                                                                      .crf = kCrf,
                                                                                      .preset = "veryfast",
                                                                                      .reproducible = true});
  if (!writer) {
    Error error = writer.error();
    if (error.id == ErrorId::Unsupported) error.message += ", or choose --images";
    return error;
  }
  return std::unique_ptr<PictureFile>(std::make_unique<Video>(writer.take()));
}

}  // namespace fourdvt::studio
