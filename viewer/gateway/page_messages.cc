#include "viewer/gateway/page_messages.h"

#include <algorithm>
#include <utility>

#include "common/picture/rectangle_outline.h"
#include "viewer/gateway/page_layout.h"
#include "viewer/gateway/page_values.h"

namespace troupe {
namespace {

// Shapes are floats: they are drawn and not calculated with.
void Write(PageWriter& writer, const Polygon& outline) {
  writer.WriteCount(outline.size());
  for (const Vec2& point : outline) {
    writer.WriteFloat(point.x());
    writer.WriteFloat(point.y());
  }
}

void Write(PageWriter& writer, const ZRange& z) {
  writer.WriteFloat(z.min);
  writer.WriteFloat(z.max);
}

void Write(PageWriter& writer, const Rectangle& r) {
  writer.WriteFloat(r.min_x);
  writer.WriteFloat(r.min_y);
  writer.WriteFloat(r.max_x);
  writer.WriteFloat(r.max_y);
}

// The pixels of an area, reduced to at most kMaxArea along each side: a byte for eight, row by row from below.
void WritePixels(PageWriter& writer, const PixelArea& area) {
  const PixelRectangle bounds = area.cover().bounds();
  const int reduction = std::max(
      {1, (bounds.x1 - bounds.x0 + kMaxArea - 1) / kMaxArea, (bounds.y1 - bounds.y0 + kMaxArea - 1) / kMaxArea});
  const int width = (bounds.x1 - bounds.x0 + reduction - 1) / reduction;
  const int height = (bounds.y1 - bounds.y0 + reduction - 1) / reduction;
  std::vector<std::uint8_t> bits((static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 7) / 8, 0);
  area.cover().ForEach([&](const PixelRectangle& r) {
    for (int y = (r.y0 - bounds.y0) / reduction; y <= (r.y1 - 1 - bounds.y0) / reduction; ++y) {
      for (int x = (r.x0 - bounds.x0) / reduction; x <= (r.x1 - 1 - bounds.x0) / reduction; ++x) {
        const std::size_t bit =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
        bits[bit >> 3] = static_cast<std::uint8_t>(bits[bit >> 3] | (1U << (bit & 7U)));
      }
    }
  });
  // Line 0 of the last pixel of a reduced row may lie beyond the bounds.
  Write(writer, area.InMetres({bounds.x0, bounds.y0, bounds.x0 + width * reduction, bounds.y0 + height * reduction}));
  PageValue<Pose>::Write(writer, area.X_MA());
  writer.WriteCount(static_cast<std::size_t>(width));
  writer.WriteCount(static_cast<std::size_t>(height));
  writer.WriteBytes(std::as_bytes(std::span(bits)));
}

}  // namespace

void PageValue<Shape>::Write(PageWriter& writer, const Shape& shape) {
  writer.WriteCount(shape.blocks.size());
  for (const Block& block : shape.blocks) {
    troupe::Write(writer, block.z);
    troupe::Write(writer, block.outline);
  }
  troupe::Write(writer, shape.rectangles_z);
  writer.WriteCount(shape.rectangles.size());
  for (const Rectangle& r : shape.rectangles) troupe::Write(writer, r);
  // Their sides, without those that two rectangles have in common.
  const std::vector<Polygon> loops = OutlineOf(shape.rectangles);
  writer.WriteCount(loops.size());
  for (const Polygon& loop : loops) troupe::Write(writer, loop);
  writer.WriteFlag(shape.area.has_value());
  if (shape.area) WritePixels(writer, *shape.area);
}

// One comparison for each row; rows of tables that the page does not show cost none.
void StateRows::Assign(std::shared_ptr<const WorldState> state, std::uint64_t number, bool fresh) {
  if (state == state_ && !fresh) return;
  std::size_t table_number = 0;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    std::vector<std::uint64_t>& changed = changed_[table_number++];
    if (!kIsShownTable<Row>) return;
    const std::vector<Row>& before = table.Of(*state_);
    const std::vector<Row>& now = table.Of(*state);
    changed.resize(now.size(), number);
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (fresh || i >= before.size() || !(before[i] == now[i])) changed[i] = number;
    }
  });
  state_ = std::move(state);
}

// Each row has its index, as most rows have not changed.
void StateRows::Write(PageWriter& writer, std::uint64_t since) const {
  std::size_t table_number = 0;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    const std::vector<std::uint64_t>& changed = changed_[table_number++];
    if constexpr (kIsShownTable<Row>) {
      const std::vector<Row>& rows = table.Of(*state_);
      const std::size_t place = writer.ReserveCount();
      std::size_t count = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (changed[i] <= since) continue;
        writer.WriteCount(i);
        PageValue<Row>::Write(writer, rows[i]);
        ++count;
      }
      writer.FillCount(place, count);
    }
  });
}

// The layout is at the start of the message, so that an old page that reconnects to a new program notices it before it
// reads anything else.
std::string EncodeWorld(const SessionMessage& session, std::uint32_t number) {
  const WorldDescription& world = session.world;
  std::string bytes;
  PageWriter writer(bytes);
  writer.Write(static_cast<std::uint8_t>(PageMessage::kWorld));
  writer.Write(PageLayout());
  writer.Write(number);
  writer.Write(session.run);
  writer.WriteText(session.host);
  PageValue<WorldDescription>::Write(writer, world);
  // The models that rows of states belong to.
  PageValue<std::vector<ModelId>>::Write(writer, FindStores(world));
  const std::vector<LightPlace> lights = FindLights(world);
  writer.WriteCount(lights.size());
  for (const LightPlace& light : lights) PageValue<ModelId>::Write(writer, light.model);
  return bytes;
}

}  // namespace troupe
