#include "common/image/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/files.h"
#include "tests/unit/common/image/picture_text.h"
#include "troupe/check.h"

namespace troupe {
namespace {

// Writes PNG files of any kind, for tests.

struct PngContent {
  int width = 0;
  int height = 0;
  int bit_depth = 8;
  int color_type = 0;  // PNG_COLOR_TYPE_*
  bool interlaced = false;
  std::vector<std::vector<std::uint8_t>> rows;     // packed as in the file, from the top
  std::vector<std::vector<std::uint8_t>> palette;  // {red, green, blue} each
};

void WritePng(const std::string& path, const PngContent& content) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  TROUPE_CHECK(file != nullptr);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, static_cast<png_uint_32>(content.width), static_cast<png_uint_32>(content.height),
               content.bit_depth, content.color_type, content.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_color> palette;
  for (const std::vector<std::uint8_t>& c : content.palette) palette.push_back({c[0], c[1], c[2]});
  if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  png_write_info(png, info);
  std::vector<png_bytep> rows;
  for (const std::vector<std::uint8_t>& row : content.rows) rows.push_back(const_cast<png_bytep>(row.data()));
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

using testing::HasSubstr;

class ImageFile : public testing::Test, public test::TemporaryFolder {
 protected:
  std::string Write(const std::string& content) const { return TemporaryFolder::Write("image", content); }
  std::string WriteImage(const PngContent& content) const {
    WritePng(Path("image.png"), content);
    return Path("image.png");
  }
};

TEST_F(ImageFile, GreyValuesAreThoseThatStageCompares) {
  const auto values = [&](const PngContent& content) {
    const Result<GreyImage> image = ReadGreyPng(WriteImage(content));
    EXPECT_TRUE(image.ok());
    return image.ok() ? image.value().values : std::vector<std::uint8_t>();
  };
  using Values = std::vector<std::uint8_t>;
  EXPECT_EQ(values({.width = 2, .height = 2, .rows = {{0, 127}, {128, 255}}, .palette = {}}),
            Values({0, 127, 128, 255}));
  EXPECT_EQ(values({.width = 3, .height = 1, .bit_depth = 1, .rows = {{0x40}}, .palette = {}}), Values({0, 255, 0}));
  EXPECT_EQ(values({.width = 1, .height = 1, .bit_depth = 16, .rows = {{0x80, 0x12}}, .palette = {}}), Values({0x80}));
  EXPECT_EQ(
      values(
          {.width = 2, .height = 1, .color_type = PNG_COLOR_TYPE_RGB, .rows = {{1, 2, 3, 200, 5, 6}}, .palette = {}}),
      Values({1, 200}));
  EXPECT_EQ(values({.width = 2, .height = 2, .interlaced = true, .rows = {{1, 2}, {3, 4}}, .palette = {}}),
            Values({1, 2, 3, 4}));
  // Written and read again.
  const GreyImage image{3, 2, {0, 50, 100, 150, 200, 250}};
  const std::string bytes = EncodeGreyPng(image).value();
  std::ofstream(Path("grey.png"), std::ios::binary) << bytes;
  EXPECT_EQ(ReadGreyPng(Path("grey.png")).value().values, image.values);
  EXPECT_EQ(bytes[24], 8);  // bits
  EXPECT_EQ(bytes[25], PNG_COLOR_TYPE_GRAY);
  std::ofstream(Path("cut.png"), std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  EXPECT_FALSE(ReadGreyPng(Path("cut.png")).ok());
  EXPECT_FALSE(ReadGreyPng(Path("none.png")).ok());
}

TEST_F(ImageFile, GreyPixelsUpTo127AreOccupied) {
  EXPECT_EQ(PictureText(WriteImage({3, 2, 8, PNG_COLOR_TYPE_GRAY, false, {{0, 127, 128}, {255, 1, 254}}, {}})),
            "##.\n.#.\n");
}

TEST_F(ImageFile, OfColoursOnlyRedCounts) {
  const std::vector<std::uint8_t> row = {255, 0, 0, 0, 255, 0, 0, 0, 255};
  EXPECT_EQ(PictureText(WriteImage({3, 1, 8, PNG_COLOR_TYPE_RGB, false, {row}, {}})), ".##\n");
}

TEST_F(ImageFile, MeanOfColoursCountsWhereTheRuleSaysSo) {
  PixelRule rule = StagePixelRule();
  rule.mean_of_channels = true;
  const std::vector<std::uint8_t> row = {255, 0, 0, 255, 255, 0, 0, 0, 0};
  EXPECT_EQ(PictureText(WriteImage({3, 1, 8, PNG_COLOR_TYPE_RGB, false, {row}, {}}), rule), "#.#\n");
}

TEST_F(ImageFile, TransparentBlackIsOccupiedByStageRuleAndFreeWhereTheRuleSaysSo) {
  PixelRule rule = StagePixelRule();
  const std::string path = WriteImage({2, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, false, {{0, 0, 0, 255}}, {}});
  EXPECT_EQ(PictureText(path, rule), "##\n");
  rule.transparent_is_free = true;
  EXPECT_EQ(PictureText(path, rule), ".#\n");
}

TEST_F(ImageFile, PalettesAreLookedUp) {
  const std::string path = WriteImage(
      {4, 1, 2, PNG_COLOR_TYPE_PALETTE, false, {{0b00011011}}, {{0, 0, 0}, {255, 255, 255}, {100, 0, 0}, {200, 0, 0}}});
  EXPECT_EQ(PictureText(path), "#.#.\n");
}

TEST_F(ImageFile, BlackAndWhiteRowsOfAnyLengthAreReadBitByBit) {
  for (const int width : {1, 8, 63, 64, 65, 131}) {
    std::vector<unsigned char> row(static_cast<std::size_t>(width + 7) / 8, 0);
    for (int x = 0; x < width; ++x) {
      if (x % 3 != 0) row[static_cast<std::size_t>(x) / 8] |= static_cast<unsigned char>(0x80 >> (x % 8));
    }
    const std::string path = WriteImage({width, 1, 1, PNG_COLOR_TYPE_GRAY, false, {row}, {}});
    PixelRule white;
    white.occupied[255] = true;
    const Bitmap blacks = ReadBitmap(path, StagePixelRule()).value();
    const Bitmap whites = ReadBitmap(path, white).value();
    for (int x = 0; x < width; ++x) {
      EXPECT_EQ(blacks.occupied(x, 0), x % 3 == 0) << x << " of " << width;
      EXPECT_EQ(whites.occupied(x, 0), x % 3 != 0) << x << " of " << width;
    }
    const std::uint64_t beyond = width % 64 == 0 ? 0 : ~((std::uint64_t{1} << (width % 64)) - 1);
    EXPECT_EQ(blacks.row(0).back() & beyond, 0u);
    EXPECT_EQ(whites.row(0).back() & beyond, 0u);
  }
}

TEST_F(ImageFile, SmallAndLargeBitDepthsAreBroughtTo8) {
  EXPECT_EQ(PictureText(WriteImage({8, 1, 1, PNG_COLOR_TYPE_GRAY, false, {{0b01010011}}, {}})), "#.#.##..\n");
  EXPECT_EQ(PictureText(WriteImage({2, 1, 4, PNG_COLOR_TYPE_GRAY, false, {{0x78}}, {}})), "#.\n");
  EXPECT_EQ(PictureText(WriteImage({2, 1, 16, PNG_COLOR_TYPE_GRAY, false, {{0x7f, 0xff, 0x80, 0x00}}, {}})), "#.\n");
}

TEST_F(ImageFile, InterlacedImagesReadTheSame) {
  PngContent content{100, 30, 8, PNG_COLOR_TYPE_GRAY, false, {}, {}};
  for (int y = 0; y < 30; ++y) {
    std::vector<std::uint8_t> row;
    for (int x = 0; x < 100; ++x) row.push_back(static_cast<std::uint8_t>((x * 37 + y * 91) % 256));
    content.rows.push_back(row);
  }
  const std::string plain = PictureText(WriteImage(content));
  content.interlaced = true;
  EXPECT_EQ(PictureText(WriteImage(content)), plain);
}

TEST_F(ImageFile, CutOffPngIsAnErrorWhereverItIsCut) {
  PngContent content{70, 40, 8, PNG_COLOR_TYPE_GRAY, false, {}, {}};
  for (int y = 0; y < 40; ++y) content.rows.push_back(std::vector<std::uint8_t>(70, static_cast<std::uint8_t>(y * 50)));
  const std::string whole = test::TextOf(WriteImage(content));
  for (std::size_t size = 8; size < whole.size(); ++size) {
    EXPECT_FALSE(ReadBitmap(Write(whole.substr(0, size)), StagePixelRule()).ok()) << size;
  }
}

TEST_F(ImageFile, DamagedPngNeverCrashes) {
  PngContent content{70, 40, 8, PNG_COLOR_TYPE_RGB, true, {}, {}};
  for (int y = 0; y < 40; ++y)
    content.rows.push_back(std::vector<std::uint8_t>(210, static_cast<std::uint8_t>(y * 50)));
  const std::string whole = test::TextOf(WriteImage(content));
  for (std::size_t i = 8; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x55);
    const Result<Bitmap> result = ReadBitmap(Write(damaged), StagePixelRule());
    if (!result.ok()) {
      EXPECT_THAT(result.error().message, HasSubstr("found"));
    }
  }
}

// A header with a size far beyond that of the file is refused before memory is allocated.
TEST_F(ImageFile, PngBombIsRefused) {
  std::string bomb = test::TextOf(WriteImage({1, 1, 8, PNG_COLOR_TYPE_GRAY, false, {{0}}, {}}));
  const auto set_size = [&bomb](std::uint32_t width, std::uint32_t height) {
    for (int i = 0; i < 4; ++i) {
      bomb[static_cast<std::size_t>(16 + i)] = static_cast<char>(width >> (24 - 8 * i));
      bomb[static_cast<std::size_t>(20 + i)] = static_cast<char>(height >> (24 - 8 * i));
    }
    const std::uint32_t sum =
        static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const unsigned char*>(bomb.data()) + 12, 17));
    for (int i = 0; i < 4; ++i) bomb[static_cast<std::size_t>(29 + i)] = static_cast<char>(sum >> (24 - 8 * i));
  };
  set_size(60'000, 60'000);
  EXPECT_THAT(PictureText(Write(bomb)), HasSubstr("which cannot hold an image of 60000 x 60000 pixels"));
  set_size(2'000'000'000, 2'000'000'000);
  EXPECT_THAT(PictureText(Write(bomb)), HasSubstr("expected at most 4000000000 pixels"));
  set_size(0, 5);
  EXPECT_THAT(PictureText(Write(bomb)), HasSubstr("damaged PNG"));
}

TEST_F(ImageFile, PgmTextWithCommentsIsRead) {
  EXPECT_EQ(PictureText(Write("P2 # plain\n# a comment\n3 #width\n2\n255\n0 127 128\n255 # more\n1 200\n")),
            "##.\n.#.\n");
}

TEST_F(ImageFile, PgmBinaryIsRead) {
  EXPECT_EQ(PictureText(Write("P5\n3 1\n255\n\x7f\x80\x01")), "#.#\n");
}

TEST_F(ImageFile, Pgm16BitIsReadByItsHighByteFirst) {
  EXPECT_EQ(PictureText(Write(std::string("P5 2 1 65535\n\x7f\xff\x80\x00", 17))), "#.\n");
}

TEST_F(ImageFile, PgmMaximumScalesTheSamples) {
  EXPECT_EQ(PictureText(Write("P2 4 1 3 0 1 2 3")), "##..\n");
}

TEST_F(ImageFile, DamagedPgmIsAnError) {
  EXPECT_THAT(PictureText(Write("P5 ")), HasSubstr("damaged PGM header"));
  EXPECT_THAT(PictureText(Write("P5 3")), HasSubstr("damaged PGM header"));
  EXPECT_THAT(PictureText(Write("P5 0 3 255\n")), HasSubstr("damaged PGM header"));
  EXPECT_THAT(PictureText(Write("P5 -3 3 255\n")), HasSubstr("damaged PGM header"));
  EXPECT_THAT(PictureText(Write("P5 3 3 70000\n")), HasSubstr("damaged PGM header"));
  EXPECT_THAT(PictureText(Write("P5 3 3 255\nabc")), HasSubstr("damaged PGM image, expected 3 x 3 pixels"));
  EXPECT_THAT(PictureText(Write("P5 60000 60000 255\nabc")), HasSubstr("which cannot hold an image of 60000 x 60000"));
  EXPECT_THAT(PictureText(Write("P5 999999999 999999999 255\nabc")), HasSubstr("expected at most 4000000000 pixels"));
  EXPECT_THAT(PictureText(Write("P2 2 1 255\n12 x4 ")), HasSubstr("damaged PGM image"));
  EXPECT_THAT(PictureText(Write("P2 2 1 255\n12 99999999999999999999 ")), HasSubstr("damaged PGM image"));
}

TEST_F(ImageFile, OtherFilesAreErrors) {
  EXPECT_THAT(PictureText(Path("missing.png")), HasSubstr("No such file"));
  EXPECT_THAT(PictureText(path()), HasSubstr("not a regular file"));
  EXPECT_THAT(PictureText("/dev/zero"), HasSubstr("not a regular file"));
  EXPECT_THAT(PictureText(Write("\x89PNG\r\n\x1a\n")), HasSubstr("damaged PNG"));
}

}  // namespace
}  // namespace troupe
