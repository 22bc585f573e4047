// SPDX-License-Identifier: Apache-2.0
// libharu also reads pictures, but decodes and compresses them again for every document.
#include "nonio/reports/picture.h"

#include <png.h>

#include <mutex>
#include <vector>

#include "font_reader.h"
#include "nonio/pdf/bytes.h"

namespace nonio::reports {
namespace {

constexpr unsigned most_pixels = 4000;
constexpr std::size_t most_bytes = 2 << 20;
constexpr int level = 9;

std::string size_error(unsigned width, unsigned height) {
  if (width > 0 && height > 0 && width <= most_pixels && height <= most_pixels) return {};
  return "it has " + std::to_string(width) + " by " + std::to_string(height) + " pixels, and " +
         std::to_string(most_pixels) + " a side is the most";
}

void compress(const std::string& pixels, Picture& picture) {
  std::string colours, opacity;
  picture.grey = true;
  bool opaque = true;
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    picture.grey = picture.grey && pixels[i] == pixels[i + 1] && pixels[i] == pixels[i + 2];
    opaque = opaque && pixels[i + 3] == '\xFF';
  }
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    colours.append(pixels, i, picture.grey ? 1 : 3);
    if (!opaque) opacity += pixels[i + 3];
  }
  picture.colours = pdf::deflated(colours, level);
  if (!opaque) picture.opacity = pdf::deflated(opacity, level);
}

std::string read_png(std::string_view bytes, Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  std::string error;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) != 0) {
    error = size_error(image.width, image.height);
    if (error.empty()) {
      image.format = PNG_FORMAT_RGBA;
      std::string pixels(PNG_IMAGE_SIZE(image), '\0');
      if (png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr) != 0) {
        picture.width = image.width;
        picture.height = image.height;
        compress(pixels, picture);
      }
    }
  }
  if (error.empty() && image.warning_or_error != 0)
    error = std::string("libpng states: ") + std::data(image.message);
  png_image_free(&image);
  return error;
}

/// Reads the frame header only (ITU-T T.81, B.2.2); the PDF reader decodes the picture.
std::string read_jpeg(std::string_view bytes, Picture& picture) {
  const FontReader r(bytes);
  for (std::size_t at = 2; r.ok();) {
    const std::uint32_t marker = r.u16(at), size = r.u16(at + 2);
    if (marker < 0xFFC0 || marker == 0xFFDA || size < 2) break;
    if (marker >= 0xFFC0 && marker <= 0xFFC2) {
      picture.height = r.u16(at + 5);
      picture.width = r.u16(at + 7);
      const std::uint32_t bits = r.u16(at + 4) >> 8, components = r.u16(at + 8) & 0xFF;
      if (bits != 8 || (components != 1 && components != 3))
        return "it has " + std::to_string(components) + " colours of " + std::to_string(bits) +
               " bits, and only grey or RGB of 8 bits can be printed";
      if (!bytes.ends_with("\xFF\xD9")) return "the file ends early";
      picture.grey = components == 1;
      picture.jpeg = true;
      picture.colours = bytes;
      return size_error(picture.width, picture.height);
    }
    at += 2 + size;
  }
  return "it has no frame header that is known";
}

Expected<Picture> read(std::string_view bytes, std::string_view name) {
  const bool png = bytes.starts_with("\x89PNG\r\n\x1A\n"), jpeg = bytes.starts_with("\xFF\xD8\xFF");
  Picture picture;
  std::string error;
  if (bytes.size() > most_bytes)
    error = "the file has " + std::to_string(bytes.size()) + " bytes, and " +
            std::to_string(most_bytes) + " is the most";
  else if (png)
    error = read_png(bytes, picture);
  else if (jpeg)
    error = read_jpeg(bytes, picture);
  else
    error = "the file begins as neither";
  if (error.empty()) return picture;
  return fail(Error{"a picture (PNG or JPEG) was expected, but " + error, std::string(name)});
}

}  // namespace

Expected<std::shared_ptr<const Picture>> shared_picture(std::string_view bytes,
                                                        std::string_view name) {
  struct Known {
    std::string bytes;
    std::shared_ptr<const Picture> picture;
  };
  struct Memo {
    std::mutex mutex;
    std::vector<Known> known;
  };
  static Memo memo;
  constexpr std::size_t most = 4;
  const std::lock_guard lock(memo.mutex);
  for (const Known& k : memo.known)
    if (k.bytes == bytes) return k.picture;
  NONIO_TRY(auto picture, read(bytes, name));
  if (memo.known.size() == most) memo.known.erase(memo.known.begin());
  memo.known.push_back({std::string(bytes), std::make_shared<Picture>(std::move(picture))});
  return memo.known.back().picture;
}

}  // namespace nonio::reports
