"""A vehicle of VDA 5050 (2.1, 3.0) without a world, for tests of fleet controls: it moves from node to node at once."""
import json

HEADERS = ("headerId", "timestamp", "version", "manufacturer", "serialNumber")


class PlainVehicle:
    """`send(topic, text, retain)` publishes; `step` drives to the next node, if that is released. `fails`: types of actions that fail."""
    def __init__(self, serial, node, position, send, version="2.1.0", fails=(), map_id="m"):
        self.serial, self.version, self.send, self.fails, self.map_id = serial, version, send, set(fails), map_id
        self.is_newer = version.startswith("3")
        self.topic = f"uagv/v{version[0]}/Plain/{serial}"
        self.headers, self.milliseconds = {}, 0
        self.order_id, self.update_id, self.last, self.sequence = "", 0, node, 0
        self.position, self.mode, self.errors = position, "AUTOMATIC", []
        self.nodes, self.edges, self.actions, self.instant = [], [], {}, {}  # what is ahead; [type, status] by actionId
        self.action_nodes, self.last_node = {}, None
        self.visited, self.is_deaf = [], False

    def start(self):
        self.publish("connection", {"connectionState": "ONLINE"}, True)
        actions = [{"actionType": kind, "actionScopes": ["NODE"], "blockingTypes": ["HARD"], "pauseAllowed": False, "cancelAllowed": False}
                   for kind in ("pick", "drop", "startCharging")]
        newer = self.is_newer
        self.publish("factsheet", {
            "typeSpecification": {
                "seriesName": "Plain", "localizationTypes": ["GRID"], ("maximumLoadMass" if newer else "maxLoadMass"): 100,
                **({"mobileRobotKinematics": "DIFFERENTIAL", "mobileRobotClass": "CARRIER", "navigationTypes": ["FREELY_NAVIGATING"]}
                   if newer else {"agvKinematic": "DIFF", "agvClass": "CARRIER", "navigationTypes": ["AUTONOMOUS"]})},
            "physicalParameters": (
                {"minimumSpeed": 0, "maximumSpeed": 1, "maximumAcceleration": 1, "maximumDeceleration": 1, "minimumHeight": 1,
                 "maximumHeight": 1, "width": 1, "length": 1} if newer else
                {"speedMin": 0, "speedMax": 1, "accelerationMax": 1, "decelerationMax": 1, "heightMin": 1, "heightMax": 1, "width": 1,
                 "length": 1}),
            "protocolLimits": (
                {"maximumStringLengths": {}, "maximumArrayLengths": {}, "timing": {"minimumOrderInterval": 0, "minimumStateInterval": 0}}
                if newer else {"maxStringLens": {}, "maxArrayLens": {}, "timing": {"minOrderInterval": 0, "minStateInterval": 0}}),
            "protocolFeatures": {
                "optionalParameters": [{"parameter": "order.nodes.nodePosition.allowedDeviationXY", "support": "SUPPORTED"}],
                ("mobileRobotActions" if newer else "agvActions"): actions},
            ("mobileRobotGeometry" if newer else "agvGeometry"): {}, "loadSpecification": {}}, True)
        self.report()

    def publish(self, topic, content, retain=False):
        self.headers[topic] = self.headers.get(topic, 0) + 1
        self.milliseconds += 10
        seconds, rest = divmod(self.milliseconds, 1000)
        digits = f"{rest:03}" if self.is_newer else f"{rest // 10:02}"
        time = f"2026-01-{1 + seconds // 86400:02}T{seconds // 3600 % 24:02}:{seconds // 60 % 60:02}:{seconds % 60:02}.{digits}Z"
        header = dict(zip(HEADERS, (self.headers[topic], time, self.version, "Plain", self.serial)))
        self.send(f"{self.topic}/{topic}", json.dumps(header | content), retain)

    def report(self):
        def states(actions):
            return [{"actionId": identity, "actionType": kind, "actionStatus": status} for identity, (kind, status) in actions.items()]

        def ahead(parts, name):
            return [{name: part[name], "sequenceId": part["sequenceId"], "released": part["released"]} for part in parts]

        x, y = self.position
        position = {"x": x, "y": y, "theta": 0, "mapId": self.map_id}
        power = {"charging": False}
        state = {"orderId": self.order_id, "orderUpdateId": self.update_id, "lastNodeId": self.last, "lastNodeSequenceId": self.sequence,
                 "nodeStates": ahead(self.nodes, "nodeId"), "edgeStates": ahead(self.edges, "edgeId"), "driving": False, "paused": False,
                 "operatingMode": self.mode, "errors": self.errors}
        if self.is_newer:
            state |= {"mobileRobotPosition": position | {"localized": True}, "powerSupply": power | {"stateOfCharge": 80},
                      "actionStates": states(self.actions), "instantActionStates": states(self.instant),
                      "safetyState": {"activeEmergencyStop": "NONE", "fieldViolation": False}}
        else:
            state |= {"agvPosition": position | {"positionInitialized": True}, "batteryState": power | {"batteryCharge": 80},
                      "actionStates": states(self.actions) + states(self.instant), "safetyState": {"eStop": "NONE", "fieldViolation": False}}
        self.publish("state", state)

    def is_busy(self):
        return bool(self.nodes or self.edges or any(status not in ("FINISHED", "FAILED") for _, status in self.actions.values()))

    def receive(self, topic, payload):
        if self.is_deaf:
            return
        message = json.loads(payload)
        if topic == "order":
            self.take(message)
        elif topic == "instantActions":
            for action in message["actions"]:
                is_cancel = action["actionType"] == "cancelOrder"
                self.instant[action["actionId"]] = [action["actionType"], "FINISHED"]
                if is_cancel:
                    self.clear()
        self.report()

    def take(self, order):
        is_same = order["orderId"] == self.order_id
        if is_same and order["orderUpdateId"] == self.update_id:
            return
        first = order["nodes"][0]
        if not is_same:
            if self.is_busy() or self.mode != "AUTOMATIC":
                return self.reject("orderError", order)
            if first["nodeId"] != self.last:
                return self.reject("noRouteError", order)
            self.actions, self.instant, self.nodes, self.edges, self.sequence, self.last_node = {}, {}, [], [], 0, first
            self.begin(order)
            return self.arrive(first)
        base = [node for node in self.nodes if node["released"]]
        end = (base[-1]["nodeId"], base[-1]["sequenceId"]) if base else (self.last, self.sequence)
        if order["orderUpdateId"] < self.update_id or end != (first["nodeId"], first["sequenceId"]):
            return self.reject("orderUpdateError", order)
        return self.begin(order)

    def begin(self, order):
        self.order_id, self.update_id, self.errors = order["orderId"], order["orderUpdateId"], []
        self.nodes = [node for node in self.nodes if node["released"]] + order["nodes"][1:]
        self.edges = [edge for edge in self.edges if edge["released"]] + order["edges"]
        known = {action["actionId"] for node in self.nodes for action in node["actions"]}
        self.actions = {identity: state for identity, state in self.actions.items() if state[1] != "WAITING" or identity in known}
        for node in self.nodes:
            for action in node["actions"]:
                self.actions.setdefault(action["actionId"], [action["actionType"], "WAITING"])
        return None

    def arrive(self, node):
        self.last, self.sequence = node["nodeId"], node["sequenceId"]
        self.visited.append(self.last)
        self.position = node["nodePosition"]["x"], node["nodePosition"]["y"]
        for action in node["actions"]:
            self.actions[action["actionId"]] = [action["actionType"], "FAILED" if action["actionType"] in self.fails else "FINISHED"]

    def reject(self, error, order):
        if self.is_newer:
            error = {"orderError": "OTHER_ORDER_ACTIVE", "noRouteError": "START_NODE_OUT_OF_RANGE"}.get(error, "VALIDATION_FAILURE")
        self.errors = [{"errorType": error, "errorLevel": "WARNING",
                        "errorReferences": [{"referenceKey": "orderId", "referenceValue": order["orderId"]}]}]

    def clear(self):
        self.nodes, self.edges = [], []
        for state in self.actions.values():
            if state[1] not in ("FINISHED", "FAILED"):
                state[1] = "FAILED"

    def take_over(self, is_manual):
        """By a person."""
        self.mode = "MANUAL" if is_manual else "AUTOMATIC"
        self.clear()
        self.report()

    def step(self):
        """Whether it has moved."""
        if not self.nodes or not self.nodes[0]["released"] or self.mode != "AUTOMATIC":
            return False
        self.edges.pop(0)
        self.arrive(self.nodes.pop(0))
        self.report()
        return True
