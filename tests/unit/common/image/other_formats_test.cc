// BMP and JPEG images, and formats that are not read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
// jpeglib.h needs stdio before it.
#include <jpeglib.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "common/image/image_file.h"
#include "tests/support/files.h"
#include "tests/unit/common/image/picture_text.h"

namespace troupe {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string Little(std::uint64_t number, std::size_t bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes; ++i) text += static_cast<char>(i < 8 ? number >> (8 * i) : 0);
  return text;
}

const std::string kBlackAndWhite("\0\0\0\0\xff\xff\xff\0", 8);
const std::string kRedAndBlue("\0\0\xff\0\xff\0\0\0", 8);

struct Bmp {
  std::uint32_t bits = 8;
  std::int32_t width = 1;
  std::int32_t height = 1;
  std::string data;
  std::string palette = {};
  std::uint32_t compression = 0;
  std::string masks = {};
  std::uint32_t header = 40;

  std::string Bytes() const {
    const bool is_old = header == 12;
    const std::size_t side = is_old ? 2 : 4;
    const std::size_t offset = 14 + header + masks.size() + palette.size();
    std::string bytes = "BM" + Little(static_cast<std::uint32_t>(offset + data.size()), 4) + Little(0, 4) +
                        Little(static_cast<std::uint32_t>(offset), 4) + Little(header, 4) +
                        Little(static_cast<std::uint32_t>(width), side) +
                        Little(static_cast<std::uint32_t>(height), side) + Little(1, 2) + Little(bits, 2);
    if (!is_old) {
      const std::size_t colors = palette.size() / 4;
      bytes += Little(compression, 4) + Little(0, 12) + Little(static_cast<std::uint32_t>(colors), 4);
      bytes.resize(14 + header, '\0');
    }
    return bytes + masks + palette + data;
  }
};

class OtherFormats : public testing::Test, public test::TemporaryFolder {
 protected:
  std::string Picture(const std::string& bytes, const PixelRule& rule = StagePixelRule()) const {
    return PictureText(Write("image", bytes), rule);
  }
};

TEST_F(OtherFormats, BmpIsReadFromTheBottomUpWithPaddedRows) {
  const Bmp image{.width = 3, .height = 2, .data = std::string("\0\1\1x\1\1\0x", 8), .palette = kBlackAndWhite};
  EXPECT_EQ(Picture(image.Bytes()), "..#\n#..\n");
  // The padding of the last row may be missing.
  EXPECT_EQ(Picture(image.Bytes().substr(0, image.Bytes().size() - 1)), "..#\n#..\n");
}

TEST_F(OtherFormats, BmpWithANegativeHeightIsReadFromTheTop) {
  const Bmp image{.width = 3, .height = -2, .data = std::string("\0\1\1x\1\1\0x", 8), .palette = kBlackAndWhite};
  EXPECT_EQ(Picture(image.Bytes()), "#..\n..#\n");
}

TEST_F(OtherFormats, BmpOfFewBitsHasItsFirstPixelInTheHighBits) {
  EXPECT_EQ(
      Picture(Bmp{.bits = 1, .width = 5, .data = std::string("\xa8\0\0\0", 4), .palette = kBlackAndWhite}.Bytes()),
      ".#.#.\n");
  EXPECT_EQ(
      Picture(Bmp{.bits = 4, .width = 3, .data = std::string("\x01\x10\0\0", 4), .palette = kBlackAndWhite}.Bytes()),
      "#..\n");
  const std::string old_palette("\0\0\0\xff\xff\xff", 6);
  EXPECT_EQ(
      Picture(Bmp{.bits = 1, .width = 5, .data = std::string("\xa8\0\0\0", 4), .palette = old_palette, .header = 12}
                  .Bytes()),
      ".#.#.\n");
}

TEST_F(OtherFormats, BmpOfColoursCountsByItsRed) {
  // Blue, green, red of each pixel: red, blue.
  const std::string two("\0\0\xff\xff\0\0\0\0", 8);
  EXPECT_EQ(Picture(Bmp{.bits = 24, .width = 2, .data = two}.Bytes()), ".#\n");
  EXPECT_EQ(Picture(Bmp{.width = 2, .data = std::string("\0\1\0\0", 4), .palette = kRedAndBlue}.Bytes()), ".#\n");
  PixelRule mean = StagePixelRule();
  mean.mean_of_channels = true;
  EXPECT_EQ(Picture(Bmp{.bits = 24, .width = 2, .data = two}.Bytes(), mean), "##\n");
  // With a fourth byte that most programs leave 0.
  EXPECT_EQ(Picture(Bmp{.bits = 32, .width = 2, .data = std::string("\0\0\xff\0\xff\0\0\0", 8)}.Bytes()), ".#\n");
}

TEST_F(OtherFormats, BmpOf16BitsIsReadByItsMasks) {
  EXPECT_EQ(Picture(Bmp{.bits = 16, .width = 2, .data = std::string("\0\x7c\0\x3c", 4)}.Bytes()), ".#\n");
  const Bmp masked{.bits = 16,
                   .width = 2,
                   .data = std::string("\0\xf8\x1f\0", 4),
                   .compression = 3,
                   .masks = Little(0xf800, 4) + Little(0x07e0, 4) + Little(0x001f, 4)};
  EXPECT_EQ(Picture(masked.Bytes()), ".#\n");
}

TEST_F(OtherFormats, BmpOfRunsIsUnpacked) {
  const auto runs = [](const std::string& data, std::uint32_t bits = 8) {
    return Bmp{.bits = bits,
               .width = 6,
               .height = 2,
               .data = data,
               .palette = kBlackAndWhite,
               .compression = bits == 8 ? 1u : 2u}
        .Bytes();
  };
  // A run of 3 and one of 3, the end of the row; 3 pixels one by one, padded, a run, the end.
  const std::string data("\3\0\3\1\0\0\0\3\0\1\0\0\3\1\0\1", 16);
  EXPECT_EQ(Picture(runs(data)), "#.#...\n###...\n");
  EXPECT_EQ(Picture(runs(std::string("\6\x01\0\0\0\4\x01\x10\2\x11\0\1", 12), 4)), "#..#..\n#.#.#.\n");
  // A step of two to the right and one up: what it leaves out has colour 0.
  EXPECT_EQ(Picture(runs(std::string("\2\1\0\2\1\1\3\1\0\1", 10))), "###...\n..####\n");
  for (std::size_t size = 62; size < 62 + 10; ++size) {
    EXPECT_THAT(Picture(runs(data).substr(0, size)), HasSubstr("damaged BMP")) << size;
  }
  EXPECT_THAT(Picture(runs(std::string("\7\1\0\1", 4))), HasSubstr("damaged BMP"));      // beyond the row
  EXPECT_THAT(Picture(runs(std::string("\0\2\0\2\0\1", 6))), HasSubstr("damaged BMP"));  // beyond the image
  EXPECT_THAT(Picture(runs(std::string("\0\7\1\1\1\1\1\1\1\0", 10))), HasSubstr("damaged BMP"));
}

TEST_F(OtherFormats, DamagedBmpIsAnErrorWhereverItIsCutAndHoweverItIsChanged) {
  const std::string whole =
      Bmp{.width = 3, .height = 2, .data = std::string("\0\1\1x\1\1\0", 7), .palette = kBlackAndWhite}.Bytes();
  for (std::size_t size = 2; size < whole.size(); ++size) {
    EXPECT_THAT(Picture(whole.substr(0, size)), HasSubstr("found")) << size;
  }
  for (std::size_t i = 2; i < whole.size(); ++i) {
    for (const int flip : {0xff, 0x80, 0x01}) {
      std::string damaged = whole;
      damaged[i] = static_cast<char>(damaged[i] ^ flip);
      EXPECT_FALSE(Picture(damaged).empty());
    }
  }
  EXPECT_THAT(Picture(Bmp{.bits = 3, .data = "abcd"}.Bytes()), HasSubstr("expected a usual one"));
  EXPECT_THAT(Picture(Bmp{.data = "abcd", .compression = 4}.Bytes()), HasSubstr("expected a usual one"));
}

TEST_F(OtherFormats, BmpBombIsRefusedBeforeMemoryIsAllocated) {
  EXPECT_THAT(
      Picture(Bmp{.bits = 1, .width = 60000, .height = 60000, .data = "abcd", .palette = kBlackAndWhite}.Bytes()),
      HasSubstr("which cannot hold an image of 60000 x 60000 pixels"));
  EXPECT_THAT(Picture(Bmp{.width = 2147483647, .height = 2147483647, .data = "abcd"}.Bytes()),
              HasSubstr("expected at most 4000000000 pixels"));
  const Bmp runs{
      .width = 60000, .height = 60000, .data = std::string("\0\1", 2), .palette = kBlackAndWhite, .compression = 1};
  EXPECT_THAT(Picture(runs.Bytes()), HasSubstr("which cannot hold an image of 60000 x 60000 pixels"));
  Bmp tall = runs;
  tall.width = 1;
  tall.height = 2000;
  EXPECT_THAT(Picture(tall.Bytes()), HasSubstr("which cannot hold"));
  Bmp lowest = runs;
  lowest.height = -2147483647 - 1;
  EXPECT_THAT(Picture(lowest.Bytes()), HasSubstr("found"));
}

// Black, but for its upper left and lower right quarter.
std::string Jpeg(int width, int height, J_COLOR_SPACE space, bool progressive) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  const int channels = space == JCS_GRAYSCALE ? 1 : space == JCS_RGB ? 3 : 4;
  jpeg.image_width = static_cast<JDIMENSION>(width);
  jpeg.image_height = static_cast<JDIMENSION>(height);
  jpeg.input_components = channels;
  jpeg.in_color_space = space;
  jpeg_set_defaults(&jpeg);
  if (progressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<unsigned char> row(static_cast<std::size_t>(width) * static_cast<std::size_t>(channels));
  for (int y = 0; y < height; ++y) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool left = static_cast<int>(i) / channels < width / 2;
      row[i] = left == (y < height / 2) ? 255 : 0;
    }
    JSAMPROW rows[1] = {row.data()};
    jpeg_write_scanlines(&jpeg, rows, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::string content(reinterpret_cast<const char*>(bytes), size);
  jpeg_destroy_compress(&jpeg);
  std::free(bytes);
  return content;
}

TEST_F(OtherFormats, JpegIsReadInAllItsKinds) {
  std::string expected;
  for (int y = 0; y < 16; ++y) expected += y < 8 ? "........########\n" : "########........\n";
  EXPECT_EQ(Picture(Jpeg(16, 16, JCS_GRAYSCALE, false)), expected);
  EXPECT_EQ(Picture(Jpeg(16, 16, JCS_GRAYSCALE, true)), expected);
  EXPECT_EQ(Picture(Jpeg(16, 16, JCS_RGB, false)), expected);
  EXPECT_EQ(Picture(Jpeg(16, 16, JCS_RGB, true)), expected);
  EXPECT_EQ(Picture(Jpeg(16, 16, JCS_CMYK, false)), expected);
}

TEST_F(OtherFormats, DamagedJpegIsAnErrorWhereverItIsCutAndNeverCrashes) {
  for (const bool progressive : {false, true}) {
    const std::string whole = Jpeg(40, 24, JCS_RGB, progressive);
    for (std::size_t size = 3; size + 2 < whole.size(); ++size) {
      EXPECT_THAT(Picture(whole.substr(0, size)), HasSubstr("damaged JPEG")) << size;
    }
    for (std::size_t i = 3; i < whole.size(); ++i) {
      std::string damaged = whole;
      damaged[i] = static_cast<char>(damaged[i] ^ 0x55);
      EXPECT_FALSE(Picture(damaged).empty());
    }
  }
}

TEST_F(OtherFormats, JpegBombIsRefused) {
  std::string bomb = Jpeg(16, 16, JCS_GRAYSCALE, false);
  const std::size_t frame = bomb.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  bomb.replace(frame + 5, 4, "\xea\x60\xea\x60");  // 60000 x 60000
  EXPECT_THAT(Picture(bomb), HasSubstr("which cannot hold an image of 60000 x 60000 pixels"));
}

TEST_F(OtherFormats, AFormatThatIsNotReadIsNamedWithAWayToConvertIt) {
  const std::string expected = ", expected PNG, JPEG, BMP or PGM (P2 or P5)";
  const auto named = [&](const std::string& bytes, const std::string& name) {
    EXPECT_THAT(Picture(bytes), StartsWith("found " + name + expected + ": "));
  };
  named("GIF89a...", "a GIF image");
  named(std::string("II*\0abcd", 8), "a TIFF image");
  named(std::string("MM\0*abcd", 8), "a TIFF image");
  named("/* XPM */\nstatic char", "an XPM image");
  named("P1\n2 2\n0 1 1 0\n", "a PBM image (P1)");
  named("P3\n2 2\n255\n", "a PPM image (P3)");
  named("P4\n2 2\n", "a PBM image (P4)");
  named("P6\n2 2\n255\n", "a PPM image (P6)");
  named("P7\nWIDTH 2\n", "a PAM image (P7)");
  named("RIFF1234WEBP", "a WebP image");
  named("<?xml version=\"1.0\"?>\n<SVG width=\"3\">", "an SVG drawing");
  named("\n<!DOCTYPE html><html>", "a web page");
  named("version https://git-lfs.github.com/spec/v1\n", "the stand-in of a file that Git LFS keeps");
  EXPECT_EQ(Picture("hello"), "found an unknown image format" + expected);
  EXPECT_EQ(Picture(""), "found an empty file" + expected);
}

}  // namespace
}  // namespace troupe
