// SPDX-License-Identifier: Apache-2.0
// JPEG by libjpeg-turbo.
//
// libjpeg reports errors by calling error_exit, which must not return. Ours jumps back, which skips
// destructors: so every call of it stands in the body of run(), and no such body holds an object
// that needs one.
#include <fmt/format.h>

#include <csetjmp>
#include <cstdio>
#include <utility>
#include <vector>
// jpeglib.h needs FILE and size_t before it.
#include <jerror.h>
#include <jpeglib.h>

#include "engine/error.hpp"
#include "pictures/decoder.hpp"
#include "pictures/exif.hpp"
#include "pictures/grey.hpp"

namespace fathom::pictures {
namespace {

/// Baseline takes two bits for an empty 8 x 8 block, progressive and arithmetic coding less.
constexpr std::uint64_t kMostShrinkage = 1 << 14;
/// Cameras use 10 at most; a thousand scans of one picture are an attack on the reader's patience.
constexpr int kMostScans = 100;

/// Whether a warning of libjpeg leaves the pixels as they were meant.
bool is_harmless(int warning) {
  return warning == JWRN_EXTRANEOUS_DATA || warning == JWRN_JFIF_MAJOR ||
         warning == JWRN_ADOBE_XFORM;
}

class JpegReader {
 public:
  JpegReader(const Source& source, Colour colour) : source_(source), colour_(colour) {
    codec_.err = jpeg_std_error(&errors_);
    errors_.error_exit = on_error;
    errors_.emit_message = on_message;
    errors_.output_message = [](j_common_ptr) {};
    codec_.client_data = this;
  }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
  ~JpegReader() { jpeg_destroy_decompress(&codec_); }

  PictureShape read_header() {
    run([this] {
      jpeg_create_decompress(&codec_);
      set_input();
      progress_.progress_monitor = on_progress;
      codec_.progress = &progress_;
      jpeg_save_markers(&codec_, JPEG_APP0 + 1, 0xffff);
      jpeg_read_header(&codec_, TRUE);
    });
    const J_COLOR_SPACE space = codec_.jpeg_color_space;
    if (space == JCS_CMYK || space == JCS_YCCK) {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{} is a CMYK picture, which has no one grey; save it as RGB or grey",
                              source_.name()));
    }
    if (space != JCS_GRAYSCALE && space != JCS_YCbCr && space != JCS_RGB) {
      throw Error(ErrorCode::bad_data, fmt::format("{} is a JPEG of {} unknown colours; save it as "
                                                   "RGB or grey",
                                                   source_.name(), codec_.num_components));
    }
    codec_.out_color_space = space == JCS_GRAYSCALE ? JCS_GRAYSCALE : JCS_RGB;
    return checked_shape(source_.name(), codec_.image_width, codec_.image_height, Depth::bits8);
  }

  bool is_colour() const { return codec_.out_color_space == JCS_RGB; }

  /// How the camera says that it was held.
  int orientation() const {
    for (auto marker = codec_.marker_list; marker != nullptr; marker = marker->next) {
      if (const auto found = exif_orientation({marker->data, marker->data_length})) return *found;
    }
    return kUpright;
  }

  Frame read_pixels(const PictureShape& shape, Colours* colours) {
    const auto width = static_cast<std::size_t>(shape.width_px);
    require_bytes_for(source_, width * shape.height_px, kMostShrinkage);
    const int channels = codec_.out_color_space == JCS_GRAYSCALE ? 1 : 3;
    std::vector<std::uint8_t> samples(width * static_cast<std::size_t>(channels));
    PixelSink<std::uint8_t> sink(shape, channels, colour_, colours);
    const int held = orientation();  // libjpeg forgets it with the last row
    run([&] {
      jpeg_start_decompress(&codec_);
      while (codec_.output_scanline < codec_.output_height) {
        const std::size_t y = codec_.output_scanline;
        JSAMPROW row = samples.data();
        jpeg_read_scanlines(&codec_, &row, 1);
        sink.put(y, samples.data());
      }
      jpeg_finish_decompress(&codec_);
    });
    if (colours != nullptr && !colours->empty()) {
      colours->bits8 =
          turned_upright(std::move(colours->bits8), shape.width_px, shape.height_px, 3, held);
    }
    const bool on_side = lies_on_its_side(held);
    return Frame(on_side ? shape.height_px : shape.width_px,
                 on_side ? shape.width_px : shape.height_px,
                 turned_upright(sink.take_grey(), shape.width_px, shape.height_px, 1, held));
  }

 private:
  static JpegReader& self(j_common_ptr codec) {
    return *static_cast<JpegReader*>(codec->client_data);
  }

  [[noreturn]] static void on_error(j_common_ptr codec) {
    codec->err->format_message(codec, self(codec).message_);
    std::longjmp(self(codec).way_back_, 1);
  }

  /// level -1 is a warning: mostly data that ended too early or made no sense, which libjpeg fills
  /// up with grey. A focus must not be measured on that.
  static void on_message(j_common_ptr codec, int level) {
    if (level < 0 && !is_harmless(codec->err->msg_code)) on_error(codec);
  }

  static void on_progress(j_common_ptr codec) {
    if (reinterpret_cast<j_decompress_ptr>(codec)->input_scan_number <= kMostScans) return;
    std::snprintf(self(codec).message_, sizeof message_, "it has more than %d scans", kMostScans);
    std::longjmp(self(codec).way_back_, 1);
  }

  void set_input() {
    input_.init_source = [](j_decompress_ptr) {};
    input_.term_source = [](j_decompress_ptr) {};
    input_.resync_to_restart = jpeg_resync_to_restart;
    input_.fill_input_buffer = [](j_decompress_ptr codec) -> boolean {
      JpegReader& reader = self(reinterpret_cast<j_common_ptr>(codec));
      const std::size_t got =
          reader.source_.read(reader.offset_, reader.buffer_, sizeof reader.buffer_);
      if (got == 0) ERREXIT(codec, JERR_INPUT_EOF);
      reader.offset_ += got;
      reader.input_.next_input_byte = reader.buffer_;
      reader.input_.bytes_in_buffer = got;
      return TRUE;
    };
    input_.skip_input_data = [](j_decompress_ptr codec, long count) {
      JpegReader& reader = self(reinterpret_cast<j_common_ptr>(codec));
      if (count <= 0) return;
      const auto skipped = static_cast<std::size_t>(count);
      if (skipped <= reader.input_.bytes_in_buffer) {
        reader.input_.next_input_byte += skipped;
        reader.input_.bytes_in_buffer -= skipped;
        return;
      }
      reader.offset_ += skipped - reader.input_.bytes_in_buffer;
      reader.input_.bytes_in_buffer = 0;
    };
    codec_.src = &input_;
  }

  template <class Body>
  void run(Body body) {
    if (!guarded(body)) throw_damaged(source_.name(), message_);
  }

  template <class Body>
  bool guarded(Body& body) {
    if (setjmp(way_back_) != 0) return false;
    body();
    return true;
  }

  const Source& source_;
  Colour colour_;
  std::uint64_t offset_ = 0;
  jpeg_decompress_struct codec_{};
  jpeg_error_mgr errors_{};
  jpeg_source_mgr input_{};
  jpeg_progress_mgr progress_{};
  std::jmp_buf way_back_{};
  char message_[JMSG_LENGTH_MAX] = "";
  JOCTET buffer_[1 << 14];
};

class JpegDecoder final : public Decoder {
 public:
  JpegDecoder(const Source& source, Colour colour) : source_(source), colour_(colour) { shape(0); }

  PictureShape shape(std::size_t) override {
    JpegReader reader(source_, colour_);
    PictureShape shape = reader.read_header();
    if (lies_on_its_side(reader.orientation())) std::swap(shape.width_px, shape.height_px);
    return shape;
  }

  bool is_colour(std::size_t) override {
    JpegReader reader(source_, colour_);
    reader.read_header();
    return reader.is_colour();
  }

  Frame read(std::size_t, Colours* colours) override {
    JpegReader reader(source_, colour_);
    return reader.read_pixels(reader.read_header(), colours);
  }

 private:
  const Source& source_;
  Colour colour_;
};

}  // namespace

std::unique_ptr<Decoder> open_jpeg(const Source& source, const PictureOptions& options) {
  return std::make_unique<JpegDecoder>(source, options.colour);
}

}  // namespace fathom::pictures
