"""What a fleet control knows of a vehicle of VDA 5050, and the messages that it sends to it."""
import datetime
import re

FINAL = ("FINISHED", "FAILED")
REJECTIONS = {"validationError", "orderError", "orderUpdateError", "noRouteError", "VALIDATION_FAILURE", "UNSUPPORTED_PARAMETER",
              "INVALID_ORDER_ACTION", "OUTDATED_ORDER_UPDATE", "SAME_ORDER_UPDATE_ID", "ORDER_UPDATE_FOLLOWING_CANCEL",
              "INSUFFICIENT_MEMORY", "NO_ROUTE_TO_TARGET", "OTHER_ORDER_ACTIVE", "START_NODE_OUT_OF_RANGE",
              "MOBILE_ROBOT_NOT_AVAILABLE", "UNKNOWN_MAP_ID"}
DEVIATION = 0.5  # m, in which a vehicle counts as at a node


class Vehicle:
    """`topic`: the levels before the last one. `send(topic, message)` publishes."""
    def __init__(self, topic, send):
        _, major, self.manufacturer, self.serial = topic.rsplit("/", 3)
        self.name = f"{self.manufacturer}/{self.serial}"
        self.topic, self.send = topic, send
        self.version = "3.0.0" if major == "v3" else "2.1.0"
        self.is_online, self.state, self.actions = False, None, None
        self.headers, self.orders = {}, 0
        self.order = None        # the order as it was sent, with all updates: {"id", "update", "route", "actions", "base", "sent", "end"}
        self.message = None      # the newest one of the order
        self.sent_at, self.asked_at = 0.0, 0.0
        self.instant = {}        # ids of instant actions that have not ended, and their types

    @property
    def is_newer(self):
        return self.version.startswith("3")

    def receive(self, topic, message):
        """Of the vehicle. Wrong members are an exception of KeyError, TypeError or ValueError."""
        if topic == "connection":
            self.is_online = message["connectionState"] == "ONLINE"
            self.version = str(message["version"])
        elif topic == "factsheet":
            features = message["protocolFeatures"]
            listed = features.get("agvActions") or features.get("mobileRobotActions") or []
            self.actions = {(action["actionType"], scope) for action in listed for scope in action["actionScopes"]}
        elif topic == "state":
            state = {"order": (message["orderId"], int(message["orderUpdateId"])), "last": message["lastNodeId"],
                     "sequence": int(message["lastNodeSequenceId"]), "nodes": len(message["nodeStates"]) + len(message["edgeStates"]),
                     "mode": message["operatingMode"], "errors": message["errors"], "driving": bool(message["driving"]),
                     "actions": {each["actionId"]: each["actionStatus"] for each in message["actionStates"]},
                     "charge": float((message.get("batteryState") or {}).get("batteryCharge", (message.get("powerSupply") or {}).get(
                         "stateOfCharge", 100.0))),
                     "position": message.get("agvPosition") or message.get("mobileRobotPosition") or {}}
            instant = {each["actionId"]: each["actionStatus"] for each in message.get("instantActionStates", message["actionStates"])}
            for identity, status in instant.items():
                if status in FINAL:
                    self.instant.pop(identity, None)
            self.state = state

    def can(self, kind, scope):
        """By its factsheet."""
        return self.actions is not None and (kind, scope) in self.actions

    @property
    def is_ready(self):
        return self.is_online and self.state is not None and self.state["mode"] in ("AUTOMATIC", "SEMIAUTOMATIC")

    @property
    def has_answered(self):
        """The state shows the newest message of the order."""
        return self.order is None or self.state["order"] == (self.order["id"], self.order["update"])

    @property
    def rejection(self):
        """The type of an error that rejects the newest message, or None."""
        for error in self.state["errors"]:
            references = {each["referenceKey"]: each["referenceValue"] for each in error.get("errorReferences") or []}
            if self.order and error["errorType"] in REJECTIONS and references.get("orderId") == self.order["id"]:
                return error["errorType"]
        return None

    @property
    def passed(self):
        """Index in the order's route of the last node that has been passed, or None while the order is not shown."""
        if self.order is None or self.state["order"][0] != self.order["id"]:
            return None
        return self.state["sequence"] // 2

    @property
    def is_idle(self):
        """Nothing of the order is left, and it is shown. An order that was not sent yet does not count."""
        if self.state["nodes"] > 0 or self.instant:
            return False
        if self.order is not None and self.order["update"] < 0:
            return True
        if not self.has_answered:
            return False
        # An order that ends early, for a job on the way home, never comes to the actions of its end.
        mine = self.order["actions"] if self.order else {}
        return all(self.state["actions"].get(action["actionId"]) in FINAL for index, actions in mine.items()
                   if index <= self.order["sent"] for action in actions)

    def failed_actions(self):
        mine = [action for actions in self.order["actions"].values() for action in actions] if self.order else []
        return [action["actionType"] for action in mine if self.state["actions"].get(action["actionId"]) == "FAILED"]

    # Messages.

    def publish(self, topic, content, now):
        header = self.headers[topic] = self.headers.get(topic, 0) + 1
        time = datetime.datetime.fromtimestamp(now, datetime.timezone.utc)
        digits = f"{time.microsecond // 1000:03}" if self.is_newer else f"{time.microsecond // 10000:02}"
        self.send(f"{self.topic}/{topic}",
                  {"headerId": header, "timestamp": f"{time:%Y-%m-%dT%H:%M:%S}.{digits}Z", "version": self.version,
                   "manufacturer": self.manufacturer, "serialNumber": self.serial} | content)

    def act(self, kind, now, parameters=()):
        identity = f"{self.serial}-{self.orders}-{kind}-{self.headers.get('instantActions', 0) + 1}"
        if kind != "stateRequest":  # a state is its answer
            self.instant[identity] = kind
        action = {"actionType": kind, "actionId": identity, "blockingType": "NONE" if self.is_newer else "HARD",
                  "actionParameters": list(parameters)}
        self.publish("instantActions", {"actions": [action]}, now)

    def start(self, route, end, actions, prefix, layout, horizon):
        """Prepares an order along a route; `actions`: lists of (type, parameters) by index in the route; `end`: index of its last node."""
        # A control that starts again goes on counting.
        shown = re.search(r"-(\d{1,9})$", self.state["order"][0])
        self.orders = max(self.orders, int(shown.group(1)) if shown else 0) + 1
        self.order = {"id": f"{prefix}-{self.serial}-{self.orders}", "update": -1, "route": route, "end": end, "base": -1, "sent": -1,
                      "horizon": horizon, "layout": layout, "actions": {}}
        for index, of_node in actions.items():
            self.order["actions"][index] = [
                {"actionType": kind, "actionId": f"{self.order['id']}-{index}-{i}", "blockingType": "HARD",
                 "actionParameters": [{"key": key, "value": value} for key, value in parameters.items()]}
                for i, (kind, parameters) in enumerate(of_node)]

    def release(self, base, now):
        """Sends the order, or an update that begins with the last node of the base, with a base up to that index of the route."""
        order = self.order
        first = max(order["base"], 0)
        last = min(base + order["horizon"], order["end"])
        order["update"] += 1
        order["base"], order["sent"] = base, last
        self.message = {"orderId": order["id"], "orderUpdateId": order["update"],
                        "nodes": [self._node(i, base) for i in range(first, last + 1)],
                        "edges": [self._edge(i, base) for i in range(first, last)]}
        self.repeat(now)

    def repeat(self, now):
        """Sends the newest message (again)."""
        self.sent_at = now
        self.publish("order", self.message, now)

    def _node(self, index, base):
        layout, number = self.order["layout"], self.order["route"][index]
        x, y = layout.positions[number]
        deviation = {"a": DEVIATION, "b": DEVIATION, "theta": 0.0} if self.is_newer else DEVIATION
        return {"nodeId": layout.names[number], "sequenceId": 2 * index, "released": index <= base,
                "nodePosition": {"x": x, "y": y, "mapId": layout.maps[number], "allowedDeviationXY": deviation},
                "actions": self.order["actions"].get(index, [])}

    def _edge(self, index, base):
        layout, route = self.order["layout"], self.order["route"]
        edge = {"edgeId": layout.names[layout.edges[route[index], route[index + 1]]], "sequenceId": 2 * index + 1,
                "released": index + 1 <= base, "actions": []}
        if not self.is_newer:
            edge |= {"startNodeId": layout.names[route[index]], "endNodeId": layout.names[route[index + 1]]}
        return edge
