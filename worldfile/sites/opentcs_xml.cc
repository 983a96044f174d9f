#include "worldfile/sites/opentcs_xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/base/xml_text.h"
#include "worldfile/sites/lif_json.h"

namespace troupe {
namespace {

constexpr double kUsualSpeed = 1.0;  // m/s, of lanes without a limit, and of vehicles

long long Millimetres(double metres) {
  return std::llround(1e3 * metres);
}

std::string Property(const char* name, const std::string& value) {
  return fmt::format("<property name=\"{}\" value=\"{}\"/>", name, XmlText(value));
}

// In the order of the schema: points, paths, vehicles, types of locations, locations, layout.
class PlantWriter {
 public:
  explicit PlantWriter(const Site& site) : site_(site), ids_(NodeIds(site)) {
    for (std::size_t i = 0; i < site.levels.size(); ++i) AddPaths(i);
    for (std::size_t i = 0; i < site.levels.size(); ++i) AddPoints(i);
  }

  std::string Text(const std::vector<PlantVehicle>& vehicles) const {
    std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>\n";
    text += fmt::format("<model version=\"6.0.0\" name=\"{}\">\n", XmlText(site_.name));
    text += points_ + paths_;
    for (const PlantVehicle& vehicle : vehicles) text += VehicleText(vehicle);
    text +=
        "  <locationType name=\"Station\"><allowedOperation name=\"NOP\"/><allowedOperation name=\"pick\"/>"
        "<allowedOperation name=\"drop\"/><locationTypeLayout locationRepresentation=\"LOAD_TRANSFER_GENERIC\"/>"
        "</locationType>\n"
        "  <locationType name=\"Charger\"><allowedOperation name=\"Charge\"/>"
        "<locationTypeLayout locationRepresentation=\"RECHARGE_GENERIC\"/></locationType>\n";
    text += locations_;
    text += "  <visualLayout name=\"Layout\" scaleX=\"50.0\" scaleY=\"50.0\">";
    for (std::size_t i = 0; i < std::max<std::size_t>(1, site_.levels.size()); ++i) {
      text += fmt::format("<layer id=\"{0}\" ordinal=\"{0}\" visible=\"true\" name=\"{1}\" groupId=\"0\"/>", i,
                          i < site_.levels.size() ? XmlText(site_.levels[i].name) : "");
    }
    return text + "<layerGroup id=\"0\" name=\"Levels\" visible=\"true\"/></visualLayout>\n</model>\n";
  }

 private:
  // The lanes of several graphs between the same vertices are one path, with the largest limit.
  void AddPaths(std::size_t i) {
    const SiteLevel& level = site_.levels[i];
    std::map<std::pair<std::size_t, std::size_t>, double> speeds;  // m/s, by start and end
    for (const SiteLane& lane : level.lanes) {
      const double speed = lane.speed_limit > 0.0 ? lane.speed_limit : kUsualSpeed;
      const auto add = [&](std::size_t start, std::size_t end) {
        double& of_path = speeds[{start, end}];
        of_path = std::max(of_path, speed);
      };
      add(lane.edge.start, lane.edge.end);
      if (lane.is_bidirectional) add(lane.edge.end, lane.edge.start);
    }
    for (const auto& [ends, speed] : speeds) {
      const auto& [start, end] = ends;
      const std::string name = XmlText(ids_[i][start] + " --- " + ids_[i][end]);
      const double length = (level.vertices[end].position - level.vertices[start].position).norm();
      used_[i].insert({start, end});
      outgoing_[{i, start}] += fmt::format("<outgoingPath name=\"{}\"/>", name);
      paths_ += fmt::format(
          "  <path name=\"{}\" sourcePoint=\"{}\" destinationPoint=\"{}\" length=\"{}\" maxVelocity=\"{}\" "
          "maxReverseVelocity=\"0\" locked=\"false\"><pathLayout connectionType=\"DIRECT\" layerId=\"{}\"/></path>\n",
          name, XmlText(ids_[i][start]), XmlText(ids_[i][end]), std::max(1LL, Millimetres(length)), Millimetres(speed),
          i);
    }
  }

  void AddPoints(std::size_t i) {
    const SiteLevel& level = site_.levels[i];
    for (const std::size_t vertex : used_[i]) {
      const SiteVertex& point = level.vertices[vertex];
      names_.insert(ids_[i][vertex]);
      const bool is_park = point.is_charger || point.is_parking_spot;
      points_ += fmt::format("  <point name=\"{}\" {} type=\"{}\">", XmlText(ids_[i][vertex]),
                             PositionText(level, point), is_park ? "PARK_POSITION" : "HALT_POSITION");
      points_ +=
          "<maxVehicleBoundingBox length=\"1000\" width=\"1000\" height=\"1000\" referenceOffsetX=\"0\" "
          "referenceOffsetY=\"0\"/>";
      points_ += outgoing_[{i, vertex}] + Property("vda5050:mapId", level.name);
      points_ += fmt::format(
          "<pointLayout positionX=\"{}\" positionY=\"{}\" labelOffsetX=\"-10\" labelOffsetY=\"-20\" "
          "layerId=\"{}\"/></point>\n",
          Millimetres(point.position.x()), Millimetres(point.position.y()), i);
    }
    for (const std::size_t vertex : used_[i]) {
      const SiteVertex& point = level.vertices[vertex];
      if (!point.dock.empty()) {
        AddLocation(i, vertex, point.dock, "Station",
                    Property("vda5050:destinationAction.pick.parameter.stationName", point.dock) +
                        Property("vda5050:destinationAction.drop.parameter.stationName", point.dock));
      }
      if (point.is_charger) AddLocation(i, vertex, "Charger at " + ids_[i][vertex], "Charger", "");
    }
  }

  // Names of all things are different in openTCS.
  void AddLocation(std::size_t i, std::size_t vertex, const std::string& wanted, const char* type,
                   const std::string& properties) {
    std::string name = wanted;
    for (int number = 2; !names_.insert(name).second; ++number) name = wanted + " " + std::to_string(number);
    const SiteVertex& point = site_.levels[i].vertices[vertex];
    locations_ += fmt::format(
        "  <location name=\"{}\" {} type=\"{}\" locked=\"false\"><link point=\"{}\"/>{}"
        "<locationLayout positionX=\"{}\" positionY=\"{}\" labelOffsetX=\"-10\" labelOffsetY=\"-20\" "
        "locationRepresentation=\"DEFAULT\" layerId=\"{}\"/></location>\n",
        XmlText(name), PositionText(site_.levels[i], point), type, XmlText(ids_[i][vertex]), properties,
        Millimetres(point.position.x()), Millimetres(point.position.y()), i);
  }

  static std::string PositionText(const SiteLevel& level, const SiteVertex& point) {
    return fmt::format("positionX=\"{}\" positionY=\"{}\" positionZ=\"{}\"", Millimetres(point.position.x()),
                       Millimetres(point.position.y()), Millimetres(level.elevation));
  }

  static std::string VehicleText(const PlantVehicle& vehicle) {
    std::string text = fmt::format(
        "  <vehicle name=\"{}\" energyLevelCritical=\"30\" energyLevelGood=\"90\" energyLevelFullyRecharged=\"90\" "
        "energyLevelSufficientlyRecharged=\"30\" maxVelocity=\"{}\" maxReverseVelocity=\"{}\">",
        XmlText(vehicle.name), Millimetres(kUsualSpeed), Millimetres(kUsualSpeed));
    text += fmt::format(
        "<boundingBox length=\"{}\" width=\"{}\" height=\"{}\" referenceOffsetX=\"0\" referenceOffsetY=\"0\"/>",
        std::max(1LL, Millimetres(vehicle.length)), std::max(1LL, Millimetres(vehicle.width)),
        std::max(1LL, Millimetres(vehicle.height)));
    text += Property("vda5050:version", "2.0") + Property("vda5050:interfaceName", vehicle.interface_name) +
            Property("vda5050:manufacturer", vehicle.manufacturer) +
            Property("vda5050:serialNumber", vehicle.serial_number) + Property("vda5050:rechargeOperation", "Charge");
    if (!vehicle.map_id.empty()) text += Property("vda5050:mapId", vehicle.map_id);
    return text + "<vehicleLayout color=\"#FF0000\"/></vehicle>\n";
  }

  const Site& site_;
  const std::vector<std::vector<std::string>> ids_;
  std::map<std::size_t, std::set<std::size_t>> used_;                    // vertices with lanes, by level
  std::map<std::pair<std::size_t, std::size_t>, std::string> outgoing_;  // of level and vertex
  std::set<std::string> names_;
  std::string points_;
  std::string paths_;
  std::string locations_;
};

}  // namespace

std::string PlantModelText(const Site& site, const std::vector<PlantVehicle>& vehicles) {
  return PlantWriter(site).Text(vehicles);
}

}  // namespace troupe
