#!/usr/bin/python3
"""Plant models of openTCS, by the facts of its schema model-6.0.0.xsd: elements in their order, attributes, names and references.

usage: plant_model_test.py --programs FOLDER
"""
import argparse
import json
import pathlib
import subprocess
import tempfile
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
# The children of an element in their order, and its attributes that are required.
SCHEMA = {
    "model": ("point path vehicle locationType location block visualLayout property", "version name"),
    "point": ("maxVehicleBoundingBox vehicleEnvelope outgoingPath property pointLayout", "name positionX positionY positionZ type"),
    "pointLayout": ("", "positionX positionY labelOffsetX labelOffsetY layerId"),
    "path": ("peripheralOperation vehicleEnvelope property pathLayout",
             "name sourcePoint destinationPoint length maxVelocity maxReverseVelocity locked"),
    "pathLayout": ("controlPoint", "connectionType layerId"),
    "vehicle": ("boundingBox property vehicleLayout", "name energyLevelCritical energyLevelGood energyLevelFullyRecharged "
                "energyLevelSufficientlyRecharged maxVelocity maxReverseVelocity"),
    "vehicleLayout": ("", "color"),
    "maxVehicleBoundingBox": ("", "length width height referenceOffsetX referenceOffsetY"),
    "boundingBox": ("", "length width height referenceOffsetX referenceOffsetY"),
    "locationType": ("allowedOperation allowedPeripheralOperation property locationTypeLayout", "name"),
    "locationTypeLayout": ("", "locationRepresentation"),
    "location": ("link property locationLayout", "name positionX positionY positionZ type locked"),
    "locationLayout": ("", "positionX positionY labelOffsetX labelOffsetY locationRepresentation layerId"),
    "link": ("allowedOperation", "point"),
    "outgoingPath": ("", "name"), "allowedOperation": ("", "name"), "property": ("", "name value"),
    "visualLayout": ("layer layerGroup property", "name scaleX scaleY"),
    "layer": ("", "id ordinal visible name groupId"), "layerGroup": ("", "id name visible"),
}
WHOLE = {"positionX", "positionY", "positionZ", "length", "width", "height", "maxVelocity", "maxReverseVelocity", "layerId", "id", "ordinal",
         "groupId", "labelOffsetX", "labelOffsetY"}


def check_schema(element):
    children, attributes = (text.split() for text in SCHEMA[element.tag])
    assert set(attributes) <= set(element.keys()), f"{element.tag}: found {element.keys()}, expected {attributes}"
    assert set(element.keys()) <= set(attributes) | {"vehicleOrientationAngle", "envelopeKey"}, f"{element.tag}: {element.keys()}"
    for name in WHOLE & set(element.keys()):
        int(element.get(name))
    places = [children.index(child.tag) for child in element]
    assert places == sorted(places), f"{element.tag}: {[child.tag for child in element]}"
    for child in element:
        check_schema(child)


def export(troupe, folder, world):
    subprocess.run([troupe, "export-map", world, "-o", folder / "plant", "--opentcs"], capture_output=True, check=True, timeout=60)
    model = xml.etree.ElementTree.parse(folder / "plant.opentcs.xml").getroot()
    check_schema(model)
    names = [element.get("name") for element in model if element.tag != "property"]
    assert len(names) == len(set(names)), "a name is used twice"
    points = {point.get("name"): point for point in model.iter("point")}
    paths = {path.get("name"): path for path in model.iter("path")}
    for path in paths.values():
        assert path.get("sourcePoint") in points and path.get("destinationPoint") in points and int(path.get("length")) > 0
    outgoing = sorted((point, each.get("name")) for point, element in points.items() for each in element.iter("outgoingPath"))
    assert outgoing == sorted((path.get("sourcePoint"), name) for name, path in paths.items())
    types = {kind.get("name") for kind in model.iter("locationType")}
    layers = {layer.get("id") for layer in model.iter("layer")}
    for location in model.iter("location"):
        assert location.get("type") in types and location.find("link").get("point") in points
    assert all(element.get("layerId") in layers for element in model.iter() if element.get("layerId") is not None)
    return model, points, paths


def properties(element):
    return {each.get("name"): each.get("value") for each in element.iter("property")}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True)
    troupe = pathlib.Path(parser.parse_args().programs) / "troupe"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        model, points, paths = export(troupe, folder, ROOT / "worlds/sites/warehouse.lif.json")
        assert (len(points), len(paths)) == (5, 6) and points["rack_1"].get("positionY") == "4000", points
        assert properties(points["rack_1"])["vda5050:mapId"] == "ground"
        places = {location.get("name"): location for location in model.iter("location")}
        assert places["shelf_a"].find("link").get("point") == "rack_1", places
        assert properties(places["shelf_a"])["vda5050:destinationAction.pick.parameter.stationName"] == "shelf_a"
        # Vehicles, and names that XML escapes.
        scenario = {"world": str(ROOT / "worlds/sites/warehouse.lif.json"), "robots": [
            {"name": "a<&>", "model": "SiteRobot", "pose": [4, 0, 0]},
            {"name": "busy", "model": "SiteRobot", "pose": [12, 0, 0], "controller": "wander"}]}
        (folder / "s.json").write_text(json.dumps(scenario))
        model, _, _ = export(troupe, folder, folder / "s.json")
        vehicles = {vehicle.get("name"): vehicle for vehicle in model.iter("vehicle")}
        assert list(vehicles) == ["a<&>"], vehicles
        of_vehicle = properties(vehicles["a<&>"])
        assert of_vehicle["vda5050:version"] == "2.0" and of_vehicle["vda5050:serialNumber"] == "a<&>", of_vehicle
        assert int(vehicles["a<&>"].find("boundingBox").get("length")) > 100
        # Buildings with several levels, chargers and maps.
        for site in ("hotel", "airport", "guesthouse"):
            model, points, _ = export(troupe, folder, ROOT / f"worlds/sites/{site}.building.yaml")
            assert len(points) > 5 and (folder / "plant.pgm").exists()
        done = subprocess.run([troupe, "export-map", ROOT / "worlds/office.world", "-o", folder / "office", "--opentcs"], capture_output=True,
                              text=True, timeout=60, check=False)
        assert done.returncode == 2 and "found no lanes" in done.stderr, done


main()
