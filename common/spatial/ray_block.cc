#include "common/spatial/ray_block.h"

#include <algorithm>
#include <bit>

#include "common/spatial/ray_shape.h"
#include "troupe/rectangle.h"

#ifdef TROUPE_HAS_AVX512
#include <immintrin.h>
#endif

namespace troupe {
namespace {

using Numbers = RayBlock::Numbers;
using Touched = RayBlock::Touched;

Float4 FourOf(const RayBlock::Lanes& lanes, std::size_t first) {
  return LoadFour(&lanes[first]);
}

// Both: a bit for each lane; NaN is near. The discs that overlap the box around the rays, and the rays that reach a
// disc.
std::uint32_t DiscsInBox(const Numbers& rays, const DiscList::Group& discs, std::size_t count) {
  std::uint32_t inside = 0;
  for (std::size_t i = 0; i < count; i += 4) {
    const Float4 disc_x = FourOf(discs.x, i);
    const Float4 disc_y = FourOf(discs.y, i);
    const Float4 x = rays.cos * disc_x + rays.sin * disc_y - rays.x;
    const Float4 y = rays.cos * disc_y - rays.sin * disc_x - rays.y;
    const Float4 reach_x = FourOf(discs.radius, i) + rays.half_width;
    const Float4 reach_y = FourOf(discs.radius, i) + rays.half_height;
    inside |= BitsOf(~((x > reach_x) | (x < -reach_x) | (y > reach_y) | (y < -reach_y))) << i;
  }
  return inside;
}

std::uint32_t RaysNear(const Numbers& rays, float disc_x, float disc_y, float radius) {
  std::uint32_t near = 0;
  for (std::size_t i = 0; i < RayBlock::kLanes; i += 4) {
    const Float4 dx = FourOf(rays.dx, i);
    const Float4 dy = FourOf(rays.dy, i);
    const Float4 along = dx * disc_x + dy * disc_y - FourOf(rays.start, i);
    const Float4 aside = dx * disc_y - dy * disc_x - FourOf(rays.across, i);
    const Bits4 apart =
        (aside > radius) | (aside < -radius) | (along < -radius) | (along > FourOf(rays.length, i) + radius);
    near |= BitsOf(~apart) << i;
  }
  return near & rays.used_lanes;
}

// Appends to `touched`, which has room for all discs, and returns their number.
std::size_t FindByFour(const Numbers& rays, const DiscList& discs, Touched* touched) {
  std::size_t count = 0;
  for (std::uint32_t first = 0; first < discs.size(); first += DiscList::kLanes) {
    const DiscList::Group& group = discs.group(first / DiscList::kLanes);
    const std::size_t lanes = std::min(DiscList::kLanes, discs.size() - first);
    for (std::uint32_t left = DiscsInBox(rays, group, lanes); left != 0; left &= left - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(left));
      const float x = group.x[lane];
      const float y = group.y[lane];
      const float radius = RayBlock::Widened(group.radius[lane], x, y, rays.spread);
      // No branch: no processor can predict it.
      touched[count] = {first + lane, RaysNear(rays, x, y, radius)};
      count += touched[count].rays != 0 ? 1 : 0;
    }
  }
  return count;
}

#ifdef TROUPE_HAS_AVX512
// The same, sixteen at a time. A comparison that is true for NaN: not greater, or not less.
[[gnu::target("avx512f")]] std::size_t FindBySixteen(const Numbers& rays, const DiscList& discs, Touched* touched) {
  const __m512 dx = _mm512_load_ps(rays.dx.data());
  const __m512 dy = _mm512_load_ps(rays.dy.data());
  const __m512 across = _mm512_load_ps(rays.across.data());
  const __m512 start = _mm512_load_ps(rays.start.data());
  const __m512 length = _mm512_load_ps(rays.length.data());
  const __m512 zero = _mm512_setzero_ps();
  std::size_t count = 0;
  for (std::uint32_t first = 0; first < discs.size(); first += DiscList::kLanes) {
    const DiscList::Group& group = discs.group(first / DiscList::kLanes);
    const __m512 discs_x = _mm512_load_ps(group.x.data());
    const __m512 discs_y = _mm512_load_ps(group.y.data());
    const __m512 radii = _mm512_load_ps(group.radius.data());
    const __m512 box_x = _mm512_abs_ps(rays.cos * discs_x + rays.sin * discs_y - rays.x);
    const __m512 box_y = _mm512_abs_ps(rays.cos * discs_y - rays.sin * discs_x - rays.y);
    std::uint32_t left = _mm512_cmp_ps_mask(box_x, radii + rays.half_width, _CMP_NGT_UQ);
    left &= _mm512_cmp_ps_mask(box_y, radii + rays.half_height, _CMP_NGT_UQ);
    for (; left != 0; left &= left - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(left));
      const float disc_x = group.x[lane];
      const float disc_y = group.y[lane];
      const float disc_radius = RayBlock::Widened(group.radius[lane], disc_x, disc_y, rays.spread);
      const __m512 radius = _mm512_set1_ps(disc_radius);
      const __m512 along = dx * disc_x + dy * disc_y - start;
      const __m512 aside = _mm512_abs_ps(dx * disc_y - dy * disc_x - across);
      __mmask16 near = _mm512_cmp_ps_mask(aside, radius, _CMP_NGT_UQ);
      near = _mm512_mask_cmp_ps_mask(near, along + radius, zero, _CMP_NLT_UQ);
      near = _mm512_mask_cmp_ps_mask(near, along, length + radius, _CMP_NGT_UQ);
      touched[count] = {first + lane, near & rays.used_lanes};
      count += touched[count].rays != 0 ? 1 : 0;
    }
  }
  return count;
}
#endif

constexpr auto kFinders = std::to_array<Variant<RayBlock::Finder>>({
    {Instructions::kAny, &FindByFour},
#ifdef TROUPE_HAS_AVX512
    {Instructions::kAvx512, &FindBySixteen},
#endif
});

RayBlock::Finder* const kQuickestFinder = RunnableOf(kFinders).back().run;

}  // namespace

std::span<const Variant<RayBlock::Finder>> RayBlock::Finders() {
  return RunnableOf(kFinders);
}

RayBlock::RayBlock(std::span<const Part> rays, double max_radius) {
  // The middle ray of a fan: the box along it is the narrowest in most cases.
  const Vec2 forward = rays[rays.size() / 2].direction;
  Rectangle box = Rectangle::Nothing();  // in a frame F with the x axis `forward`
  double spread = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto& [origin, direction, length] = rays[i];
    const Vec2 origin_F(forward.dot(origin), Cross(forward, origin));
    const Vec2 direction_F(forward.dot(direction), Cross(forward, direction));
    box.Extend(origin_F);
    box.Extend(origin_F + length * direction_F);
    const double across = Cross(direction, origin);
    const double start = direction.dot(origin);
    numbers_.dx[i] = static_cast<float>(direction.x());
    numbers_.dy[i] = static_cast<float>(direction.y());
    numbers_.across[i] = static_cast<float>(across);
    numbers_.start[i] = static_cast<float>(start);
    numbers_.length[i] = static_cast<float>(length);
    spread = std::max({spread, std::abs(across), std::abs(start), length});
  }
  numbers_.spread = static_cast<float>(spread);
  numbers_.used_lanes = (1u << rays.size()) - 1;
  // The numbers of a disc that overlaps the box are not larger than those of the box and its radius together, so this
  // makes up for the rounding of both.
  constexpr double kRounding = 2e-6;  // many times that of a float
  const Vec2 center = box.center();
  const double rounding =
      kRounding * (std::abs(center.x()) + std::abs(center.y()) + box.width() + box.height() + max_radius);
  numbers_.cos = static_cast<float>(forward.x());
  numbers_.sin = static_cast<float>(forward.y());
  numbers_.x = static_cast<float>(center.x());
  numbers_.y = static_cast<float>(center.y());
  numbers_.half_width = static_cast<float>(0.5 * box.width() + rounding);
  numbers_.half_height = static_cast<float>(0.5 * box.height() + rounding);
}

void RayBlock::FindTouched(const DiscList& discs, std::vector<Touched>& touched) const {
  FindTouched(discs, touched, kQuickestFinder);
}

void RayBlock::FindTouched(const DiscList& discs, std::vector<Touched>& touched, Finder* finder) const {
  touched.resize((discs.size() + DiscList::kLanes - 1) / DiscList::kLanes * DiscList::kLanes);
  std::size_t count = finder(numbers_, discs, touched.data());
  // Lanes without a disc, with any numbers, are the last.
  // Discs are found in order.
  while (count > 0 && touched[count - 1].disc >= discs.size()) --count;
  touched.resize(count);
}

}  // namespace troupe
