// From an image file to the rectangles of the static map.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/image/image_file.h"
#include "troupe/rectangle_cover.h"

namespace troupe {
namespace {

// Rooms of 100 x 60 pixels with doors.
bool IsWall(int x, int y) {
  const int room_x = x % 100;
  const int room_y = y % 60;
  return (room_x < 3 && (room_y < 25 || room_y > 35)) || (room_y < 3 && (room_x < 45 || room_x > 55));
}

void BM_CoverByRectangles(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0));
  Bitmap bitmap(width, width / 2);
  for (int y = 0; y < bitmap.height(); ++y) {
    for (int x = 0; x < width; ++x) bitmap.set_occupied(x, y, IsWall(x, y));
  }
  std::size_t rectangles = 0;
  for (auto _ : state) rectangles = CoverByRectangles(bitmap).size();
  state.counters["rectangles"] = static_cast<double>(rectangles);
  state.SetItemsProcessed(state.iterations() * width * (width / 2));
}
BENCHMARK(BM_CoverByRectangles)->Arg(1000)->Arg(10'000)->Unit(benchmark::kMillisecond);

// A PGM file, so that decompression does not count.
void BM_ReadImage(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0));
  const std::string path =
      (std::filesystem::temp_directory_path() / ("troupe-bench-" + std::to_string(getpid()) + ".pgm")).string();
  std::ofstream file(path, std::ios::binary);
  file << "P5 " << width << " " << width / 2 << " 255\n";
  for (int y = 0; y < width / 2; ++y) {
    for (int x = 0; x < width; ++x) file.put(IsWall(x, y) ? '\0' : '\xff');
  }
  file.close();
  for (auto _ : state) {
    if (!ReadBitmap(path, StagePixelRule()).ok()) state.SkipWithError("cannot read the image");
  }
  std::filesystem::remove(path);
  state.SetItemsProcessed(state.iterations() * width * (width / 2));
}
BENCHMARK(BM_ReadImage)->Arg(1000)->Arg(10'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace troupe
