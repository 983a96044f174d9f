#include "common/image/foreign_format.h"

#include <array>

namespace troupe {
namespace {

struct Format {
  std::string_view start;
  std::string_view name;
  std::string_view advice;
};

constexpr std::string_view kConvert = "convert it to PNG, for instance by ImageMagick's 'convert'";

constexpr std::array kFormats{
    Format{"GIF8", "a GIF image", kConvert},
    Format{std::string_view("II*\0", 4), "a TIFF image", kConvert},
    Format{std::string_view("MM\0*", 4), "a TIFF image", kConvert},
    Format{"/* XPM */", "an XPM image", kConvert},
    Format{"#define", "an XBM image", kConvert},
    Format{"P1", "a PBM image (P1)", kConvert},
    Format{"P3", "a PPM image (P3)", kConvert},
    Format{"P4", "a PBM image (P4)", kConvert},
    Format{"P6", "a PPM image (P6)", kConvert},
    Format{"P7", "a PAM image (P7)", kConvert},
    Format{"Pf", "a PFM image", kConvert},
    Format{"PF", "a PFM image", kConvert},
    Format{"RIFF", "a WebP image", kConvert},
    Format{"\x8aMNG", "an MNG image", kConvert},
    Format{std::string_view("\0\0\1\0", 4), "an icon (ICO)", kConvert},
    Format{"8BPS", "an image of Photoshop (PSD)", kConvert},
    Format{"gimp xcf", "an image of Gimp (XCF)", "export it as PNG"},
    Format{std::string_view("\0\0\0\x0cjP", 6), "a JPEG 2000 image", kConvert},
    Format{"\xff\x4f\xff\x51", "a JPEG 2000 image", kConvert},
    Format{"\x0a\x05\x01", "a PCX image", kConvert},
    Format{"%PDF", "a PDF file", kConvert},
    Format{"%!PS", "a PostScript file", kConvert},
    Format{"AC10", "a drawing (DWG)", "export it as PNG"},
    Format{"version https://git-lfs", "the stand-in of a file that Git LFS keeps", "get the file by 'git lfs pull'"},
};

// In any case of letters.
bool Contains(std::string_view text, std::string_view lower_case) {
  for (std::size_t at = 0; at + lower_case.size() <= text.size(); ++at) {
    bool same = true;
    for (std::size_t i = 0; same && i < lower_case.size(); ++i) {
      const char c = text[at + i];
      same = (c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c) == lower_case[i];
    }
    if (same) return true;
  }
  return false;
}

}  // namespace

std::string DescribeForeignFormat(std::string_view start) {
  constexpr std::string_view kExpected = ", expected PNG, JPEG, BMP or PGM (P2 or P5)";
  const auto text = [&](std::string_view name, std::string_view advice) {
    return "found " + std::string(name) + std::string(kExpected) + ": " + std::string(advice);
  };
  if (start.empty()) return "found an empty file" + std::string(kExpected);
  for (const Format& format : kFormats) {
    if (start.starts_with(format.start)) return text(format.name, format.advice);
  }
  if (Contains(start, "<svg")) return text("an SVG drawing", kConvert);
  if (Contains(start, "<html") || Contains(start, "<!doctype html")) {
    return text("a web page", "save the image itself, on GitHub by 'Raw'");
  }
  return "found an unknown image format" + std::string(kExpected);
}

}  // namespace troupe
