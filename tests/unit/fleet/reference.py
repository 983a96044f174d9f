#!/usr/bin/python3
"""Judges random sequences of VDA 5050 messages a second time, from the text of the standard and not from the code.

usage: reference.py FLEET_SEQUENCES FIRST COUNT

Each line that fleet_sequences writes has an input and what the vehicle made of it. The Vehicle below reads the same
payloads by itself and has to come to the same decision, state and permission to drive after every input, and Fleet to the
same verdicts about orders. It keeps a whole order with a mark where the vehicle is, where the code keeps what is left.
"""
import json
import math
import re
import subprocess
import sys

FINAL = ("FINISHED", "FAILED")
FLEET_RULES = {"order_form", "order_begins_at_zero", "new_order_update_zero", "update_id_grows", "orders_in_modes",
               "new_order_when_idle", "message_form"}
ORDER_ACTIONS = {"pick": "NE", "drop": "NE", "blink": "NE", "waitForTrigger": "N", "startCharging": "IN",
                 "initPosition": "IN", "logReport": "I", "enableMap": "IN", "deleteMap": "I", "downloadMap": "I"}
NOT_PAUSED = {"blink", "waitForTrigger", "startCharging", "initPosition", "logReport", "enableMap", "deleteMap",
              "downloadMap", "clearInstantActions"}
NOT_CANCELLED = {"blink", "enableMap", "deleteMap", "downloadMap", "clearInstantActions"}


class Bad(Exception):
    pass


# ------------------------------------------------------------------------------------------------------- the payloads

def no_duplicates(pairs):
    keys = [key for key, _ in pairs]
    if len(keys) != len(set(keys)):
        raise Bad("a key twice")
    return dict(pairs)


def constant(name):
    raise Bad(name)


def parse(payload):
    try:
        value = json.loads(payload, object_pairs_hook=no_duplicates, parse_constant=constant)
    except (ValueError, RecursionError) as error:
        raise Bad(str(error)) from error
    return value


def number(value, low=-math.inf, high=math.inf, turns=False):
    if isinstance(value, str):
        if not re.fullmatch(r" *-?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)? *", value):
            raise Bad("no number")
        value = float(value)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise Bad("no number")
    if not low <= value <= high:
        if not turns or abs(value) > 1e6:
            raise Bad("out of range")
    return value


def whole(value):
    value = number(value, 0, 2 ** 32 - 1)
    if value != int(value):
        raise Bad("a fraction")
    return int(value)


def flag(value):
    if isinstance(value, bool):
        return value
    if isinstance(value, str) and value.lower() in ("true", "false"):
        return value.lower() == "true"
    if isinstance(value, (int, float)) and value in (0, 1):
        return value == 1
    raise Bad("no flag")


def text(value):
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise Bad("no text")
    return value if isinstance(value, str) else json.dumps(value)


def one_of(*names):
    def read(value):
        if not isinstance(value, str):
            raise Bad("no name")
        plain = value.upper().replace("_", "")
        for name in names:
            if plain == name.replace("_", ""):
                return name
        raise Bad("another name")
    return read


def anything(value):
    return value


def many(read):
    def each(value):
        if not isinstance(value, list):
            raise Bad("no list")
        return [read(item) for item in value]
    return each


def record(needed, optional=None, lists=None):
    """lists: may be missing or null for an empty one."""
    def read(value):
        if not isinstance(value, dict):
            raise Bad("no object")
        result = {}
        for key, of in needed.items():
            if key not in value:
                raise Bad("no " + key)
            result[key] = of(value[key])
        for key, of in (optional or {}).items():
            result[key] = of(value[key]) if value.get(key) is not None else None
        for key, of in (lists or {}).items():
            result[key] = of(value[key]) if value.get(key) is not None else []
        return result
    return read


def timestamp(value):
    value = text(value)
    if not re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z", value):
        raise Bad("no time")
    return value


def header(version):
    def major(value):
        value = text(value)
        if not re.match(("3" if version == "3.0" else "2") + r"\.\d+", value):
            raise Bad("another version")
        return value
    return {"headerId": whole, "timestamp": timestamp, "version": major, "manufacturer": text, "serialNumber": text}


def angle(value):
    return number(value, -math.pi - 1e-9, math.pi + 1e-9, True)


def positive(value):
    return number(value, 0)


def schema(version):
    newer = version == "3.0"
    parameter = record({"key": text, "value": anything})
    description = "Descriptor" if newer else "Description"
    action = record({"actionType": text, "actionId": text, "blockingType": one_of("NONE", "SOFT", "SINGLE", "HARD")},
                    {"action" + description: text, "actionParameters": many(parameter),
                     **({"retriable": flag} if newer else {})})

    def deviation(value):
        if isinstance(value, dict):
            return record({"a": positive, "b": positive, "theta": number})(value)
        return positive(value)
    position = record({"x": number, "y": number, "mapId": text},
                      {"theta": angle, "allowedDeviationXY": deviation, "allowedDeviationTheta": number})
    node = record({"nodeId": text, "sequenceId": whole, "released": flag},
                  {"node" + description: text, "nodePosition": position}, {"actions": many(action)})
    edge = record({"edgeId": text, "sequenceId": whole, "released": flag,
                   **({} if newer else {"startNodeId": text, "endNodeId": text})},
                  {"edge" + description: text, "orientation": angle}, {"actions": many(action)})
    order = record({**header(version), "orderId": text, "orderUpdateId": whole, "nodes": many(node), "edges": many(edge)})
    instant = record({**header(version), "actions": many(action)})
    return order, instant


# -------------------------------------------------------------------------------------------------- what orders must be

def has_form(order, version):
    nodes, edges = order["nodes"], order["edges"]
    if not order["orderId"] or not nodes or len(edges) != len(nodes) - 1:
        return False
    way = [nodes[0]]
    for edge, node in zip(edges, nodes[1:]):
        way += [edge, node]
    first = nodes[0]["sequenceId"]
    released = [part["released"] for part in way]
    if [part["sequenceId"] for part in way] != list(range(first, first + len(way))):
        return False
    if not released[0] or sorted(released, reverse=True) != released:
        return False
    if released.count(True) % 2 == 0:  # an edge without its end
        return False
    if any(not part.get("nodeId", part.get("edgeId")) for part in way):
        return False
    if version != "3.0":
        for edge, before, behind in zip(edges, nodes, nodes[1:]):
            if (edge["startNodeId"], edge["endNodeId"]) != (before["nodeId"], behind["nodeId"]):
                return False
    ids = [action["actionId"] for part in way for action in part["actions"]]
    return all(ids) and len(ids) == len(set(ids))


def parameter_of(action, key):
    for parameter in action["actionParameters"] or []:
        if parameter["key"] == key:
            value = parameter["value"]
            return value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
    return None


def can_execute(action, scope, version):
    kind = action["actionType"]
    scopes = ORDER_ACTIONS.get(kind, "IN" if kind == "clearInstantActions" and version == "3.0" else "")
    if scope not in scopes:
        return False
    if kind.endswith("Map"):
        for key in ("mapId", "mapVersion"):
            value = next((p["value"] for p in action["actionParameters"] or [] if p["key"] == key), None)
            if isinstance(value, bool) or not isinstance(value, (str, int, float)):
                return False
    return True


# ------------------------------------------------------------------------------------------------------- the vehicle

class Vehicle:
    def __init__(self, version, stops):
        self.version, self.newer, self.stops = version, version == "3.0", stops
        self.read_order, self.read_instant = schema(version)
        self.order_id, self.update_id, self.accepted = "", 0, None
        self.way, self.at, self.entered = [], 0, False  # of the order: parts, the last one that is passed
        self.last, self.standing = ("", 0), False
        self.actions, self.instant = [], []
        self.turn = []  # triggered actions that wait
        self.clearing = self.cancelled = self.driving = self.paused = False
        self.mode, self.next_mode = "AUTOMATIC", None
        self.errors = []  # (type, level, until)
        self.maps = [["L1", "1", "ENABLED"], ["L1", "2", "DISABLED"]]
        self.x = 0.0

    # What is left of the order.
    def ahead(self):
        return self.way[self.at + 1:] if self.way else []

    def busy(self):
        return self.clearing or bool(self.ahead()) or any(a["status"] not in FINAL for a in self.actions)

    def automatic(self):
        return self.mode in ("AUTOMATIC", "SEMIAUTOMATIC") and not self.next_mode

    def running(self):
        return [a for a in self.actions + self.instant if a["status"] not in FINAL + ("WAITING",) and
                not (a["instant"] and a["type"] in ("startPause", "cancelOrder"))]

    def halted(self):
        return any(level in ("CRITICAL", "FATAL") for _, level, _ in self.errors)

    def may_drive(self):
        nodes = [part for part in self.ahead() if "nodeId" in part]
        if not nodes or not nodes[0]["released"] or not self.automatic() or self.paused or self.halted():
            return False
        if self.clearing and (self.stops or not self.entered):
            return False
        return not any(a["blocking"] in ("SOFT", "HARD") for a in self.running() + self.turn)

    # Orders.
    def decide(self, payload):
        try:
            order = self.read_order(parse(payload))
            if not has_form(order, self.version):
                return "invalid", None
        except Bad:
            return "invalid", None
        same = order["orderId"] == self.order_id
        update, held = order["orderUpdateId"], self.update_id
        if same:
            if update < held:
                return "outdated_update", order
            if self.newer and (self.cancelled or self.clearing) or self.clearing and update > held:
                return "after_cancel", order
            if update == held:
                unchanged = self.content(order) == self.accepted
                return ("resend" if unchanged or not self.newer else "changed_resend"), order
        if self.mode not in ("AUTOMATIC", "SEMIAUTOMATIC", "INTERVENED") or self.next_mode:
            return "mode_without_orders", order
        if any(level == "FATAL" for _, level, _ in self.errors):
            return "fatal_error", order
        if any(edge["orientation"] is not None for edge in order["edges"]) or any(
                node["nodePosition"] and (node["nodePosition"]["theta"] is not None or
                                          node["nodePosition"]["allowedDeviationTheta"] is not None)
                for node in order["nodes"]):
            return "unsupported_parameter", order
        for scope, parts in (("N", order["nodes"]), ("E", order["edges"])):
            if any(not can_execute(action, scope, self.version) for part in parts for action in part["actions"]):
                return "unsupported_action", order
        fresh = [a["actionId"] for part in (order["nodes"][1:] if same else order["nodes"]) + order["edges"]
                 for a in part["actions"]]
        taken = {a["id"] for a in self.actions if a["released"] or a["status"] in FINAL} if same else set()
        if not self.newer:
            taken |= {a["id"] for a in self.instant if same or a["status"] not in FINAL}
        if taken & set(fresh):
            return "reused_action_id", order
        if self.maps and any(node["nodePosition"] and node["nodePosition"]["mapId"] and
                             node["nodePosition"]["mapId"] not in [m[0] for m in self.maps] for node in order["nodes"]):
            return "unknown_map", order
        first = order["nodes"][0]
        if not same:
            if self.busy():
                return "other_order_active", order
            if self.newer and update != 0:
                return "update_without_order", order
            return ("new_order" if self.near(first) else "start_too_far"), order
        begin = (first["nodeId"], first["sequenceId"])
        if self.busy():
            ends = [(p["nodeId"], p["sequenceId"]) for p in self.ahead() if "nodeId" in p and p["released"]]
            return ("update_of_base" if begin == (ends or [self.last])[-1] else "update_breaks_base"), order
        return ("update_of_finished" if begin == self.last else "update_breaks_finished"), order

    @staticmethod
    def content(order):
        return {key: value for key, value in order.items()
                if key not in ("headerId", "timestamp", "version", "manufacturer", "serialNumber")}

    def near(self, node):
        if self.standing and node["nodeId"] == self.last[0]:
            return True
        position = node["nodePosition"]
        if not position or position["mapId"] not in ("", "L1"):
            return False
        radius = 0.1
        if isinstance(position["allowedDeviationXY"], dict):
            radius = max(radius, min(position["allowedDeviationXY"]["a"], position["allowedDeviationXY"]["b"]))
        elif position["allowedDeviationXY"] is not None:
            radius = max(radius, position["allowedDeviationXY"])
        return math.hypot(float(position["x"]) - self.x, float(position["y"])) <= radius

    OLD_ERRORS = {"invalid": "validationError", "outdated_update": "orderUpdateError", "after_cancel": "orderUpdateError",
                  "reused_action_id": "validationError", "start_too_far": "noRouteError",
                  "update_breaks_base": "orderUpdateError", "update_breaks_finished": "orderUpdateError"}
    NEW_ERRORS = {"invalid": "VALIDATION_FAILURE", "outdated_update": "OUTDATED_ORDER_UPDATE",
                  "after_cancel": "ORDER_UPDATE_FOLLOWING_CANCEL", "changed_resend": "SAME_ORDER_UPDATE_ID",
                  "mode_without_orders": "MOBILE_ROBOT_NOT_AVAILABLE", "fatal_error": "MOBILE_ROBOT_NOT_AVAILABLE",
                  "unsupported_parameter": "UNSUPPORTED_PARAMETER", "unsupported_action": "INVALID_ORDER_ACTION",
                  "reused_action_id": "VALIDATION_FAILURE", "unknown_map": "UNKNOWN_MAP_ID",
                  "other_order_active": "OTHER_ORDER_ACTIVE", "update_without_order": "VALIDATION_FAILURE",
                  "start_too_far": "START_NODE_OUT_OF_RANGE", "update_breaks_base": "VALIDATION_FAILURE",
                  "update_breaks_finished": "VALIDATION_FAILURE"}

    def on_order(self, payload):
        row, order = self.decide(payload)
        if row == "resend":
            return row
        if row not in ("new_order", "update_of_base", "update_of_finished"):
            kind = self.NEW_ERRORS[row] if self.newer else self.OLD_ERRORS.get(row, "orderError")
            self.errors.append((kind, "CRITICAL" if kind == "UNSUPPORTED_PARAMETER" else "WARNING", "order"))
            return row
        self.errors = [e for e in self.errors if e[2] not in (("order", "new") if row == "new_order" else ("order",))]
        parts = [order["nodes"][0]]
        for edge, node in zip(order["edges"], order["nodes"][1:]):
            parts += [edge, node]
        if row == "new_order":
            self.actions, self.turn, self.cancelled = [], [], False
            if not self.newer:
                self.instant = [a for a in self.instant if a["status"] not in FINAL]
            self.way, self.at, self.entered = parts, 0, False
            new = parts
        else:
            left = [p for p in self.ahead() if p["released"]]
            self.actions = [a for a in self.actions if a["released"] or a["status"] != "WAITING"]
            new = parts[1:]
            self.way, self.at = [None] + left + new, 0
        for part in new:
            for action in part["actions"]:
                self.actions.append(self.track(action, part))
        self.order_id, self.update_id, self.accepted = order["orderId"], order["orderUpdateId"], self.content(order)
        if row == "new_order":
            self.pass_node(parts[0])
        return row

    @staticmethod
    def track(action, part=None):
        return {"id": action["actionId"], "type": action["actionType"], "blocking": action["blockingType"],
                "status": "WAITING", "released": part["released"] if part else True, "instant": part is None,
                "place": part["sequenceId"] if part else None, "edge": bool(part) and "edgeId" in part,
                "retriable": bool(action.get("retriable")), "action": action}

    def pass_node(self, node):
        self.last, self.standing, self.entered = (node["nodeId"], node["sequenceId"]), True, False
        self.turn += [a for a in self.actions
                      if a["place"] == node["sequenceId"] and not a["edge"] and a["status"] == "WAITING"]

    def on_node(self, sequence):
        ahead = self.ahead()
        nodes = [part for part in ahead if "nodeId" in part]
        if not nodes or nodes[0]["sequenceId"] != sequence or not nodes[0]["released"]:
            return
        while self.way[self.at + 1] is not nodes[0]:
            self.at += 1
            for a in self.actions:
                if a["edge"] and a["place"] == self.way[self.at]["sequenceId"] and a["status"] not in FINAL:
                    a["status"] = "FAILED" if a["status"] == "WAITING" else "FINISHED"
            self.turn = [a for a in self.turn if a["status"] == "WAITING"]
        self.at += 1
        self.pass_node(nodes[0])

    # Actions.
    def begin(self, a):
        a["status"] = "INITIALIZING"
        wanted = [parameter_of(a["action"], "mapId"), parameter_of(a["action"], "mapVersion")]
        found = [m for m in self.maps if m[:2] == wanted]
        if a["type"] == "enableMap":
            a["status"] = "FINISHED" if found else "FAILED"
            for m in self.maps if found else []:
                if m[0] == wanted[0]:
                    m[2] = "ENABLED" if m is found[0] else "DISABLED"
        elif a["type"] == "deleteMap":
            a["status"] = "FINISHED" if found and found[0][2] == "DISABLED" else "FAILED"
            if a["status"] == "FINISHED":
                self.maps.remove(found[0])
        elif a["type"] == "downloadMap" and found:
            a["status"] = "FAILED"
            self.fail(a, "DUPLICATE_MAP")
        elif a["type"] == "waitForTrigger":
            a["status"] = "RUNNING"

    def settle(self):
        for _ in range(1000):
            before = repr((self.turn, self.entered, self.clearing, [a["status"] for a in self.actions + self.instant]))
            for a in self.instant:
                if a["type"] == "startPause" and a["status"] not in FINAL:
                    if not self.paused:
                        a["status"] = "FAILED"
                    elif not self.driving:
                        a["status"] = "FINISHED"
            self.end_clearing()
            while (self.turn and self.automatic() and not self.paused and not self.clearing and not self.halted()):
                a, running = self.turn[0], self.running()
                alone = ("HARD", "SINGLE")
                if running and (a["blocking"] in alone or any(r["blocking"] in alone for r in running)):
                    break
                if self.driving and a["blocking"] in ("SOFT", "HARD"):
                    break
                self.begin(self.turn.pop(0))
            if not self.entered and self.ahead() and "edgeId" in self.ahead()[0] and self.may_drive():
                self.entered, self.standing = True, False
                self.turn += [a for a in self.actions if a["edge"] and a["place"] == self.ahead()[0]["sequenceId"] and
                              a["status"] == "WAITING"]
            if before == repr((self.turn, self.entered, self.clearing, [a["status"] for a in self.actions + self.instant])):
                return

    def on_progress(self, identity, status, error):
        a = next((a for a in self.actions + self.instant if a["id"] == identity), None)
        if a is None or a not in self.running() or (status == "INITIALIZING" and a["status"] != "INITIALIZING"):
            return
        a["status"] = status
        if status == "FAILED":
            if self.newer and a["retriable"] and not a["instant"] and not self.clearing:
                a["status"] = "RETRIABLE"
            if error:
                self.errors.append(("broken", "CRITICAL", "new", identity))
                self.errors[-1] = Error(self.errors[-1])
        if status == "FINISHED" and a["type"] == "initPosition" and not self.busy() and parameter_of(a["action"], "lastNodeId"):
            self.last, self.standing = (parameter_of(a["action"], "lastNodeId"), 0), True
        if status == "FINISHED" and a["type"] == "downloadMap":
            wanted = [parameter_of(a["action"], "mapId"), parameter_of(a["action"], "mapVersion")]
            if not [m for m in self.maps if m[:2] == wanted]:
                self.maps.append(wanted + ["DISABLED"])

    def begin_clearing(self):
        self.clearing, self.turn = True, []
        for a in self.actions:
            if a["status"] in ("WAITING", "RETRIABLE") or (a["status"] not in FINAL and a["type"] not in NOT_CANCELLED):
                a["status"] = "FAILED"
        if not self.stops and not self.next_mode:
            self.way = self.way[:self.at + 1 + (2 if self.entered else 0)]

    def end_clearing(self):
        if not self.clearing or any(a["status"] not in FINAL for a in self.actions):
            return
        if not self.next_mode and (self.driving or not (self.stops or not self.entered)):
            return
        self.way, self.at, self.entered, self.clearing, self.cancelled = [], 0, False, False, True
        for a in self.instant:
            if a["type"] == "cancelOrder" and a["status"] not in FINAL:
                a["status"] = "FINISHED"
        if self.next_mode:
            self.enter(self.next_mode)

    def enter(self, mode):
        self.mode, self.next_mode = mode, None
        if mode in ("AUTOMATIC", "SEMIAUTOMATIC", "INTERVENED"):
            return
        self.standing = False
        if self.newer and mode != "MANUAL":
            self.last = ("", 0)

    def on_mode(self, mode):
        if not self.newer:
            mode = {"INTERVENED": "MANUAL", "STARTUP": "SERVICE"}.get(mode, mode)
        keeps = mode in ("AUTOMATIC", "SEMIAUTOMATIC", "INTERVENED")
        if self.next_mode:
            self.next_mode = self.next_mode if keeps else mode
        elif mode not in ("AUTOMATIC", "SEMIAUTOMATIC", "INTERVENED") and self.busy():
            self.next_mode = mode
            self.begin_clearing()
        else:
            self.enter(mode)

    def pause(self, paused):
        if paused == self.paused:
            return
        self.paused = paused
        for a in self.running():
            if paused and a["status"] in ("INITIALIZING", "RUNNING") and a["type"] not in NOT_PAUSED:
                a["status"] = "PAUSED"
            elif not paused and a["status"] == "PAUSED":
                a["status"] = "RUNNING"

    def on_instant(self, payload):
        try:
            message = self.read_instant(parse(payload))
            ids = [a["actionId"] for a in message["actions"]]
            if not all(ids) or len(ids) != len(set(ids)):
                raise Bad("ids")
        except Bad:
            self.errors.append(("INVALID_INSTANT_ACTION", "WARNING", "instant"))
            return
        earlier, accepted = [e for e in self.errors if e[2] == "instant"], False
        for action in message["actions"]:
            known = self.instant + ([] if self.newer else self.actions)
            if action["actionId"] in [a["id"] for a in known]:
                continue
            a = self.track(action)
            if self.newer and a["type"] == "clearInstantActions" and self.automatic():
                self.instant = [other for other in self.instant if other["status"] not in FINAL]
            self.instant.append(a)
            self.execute(a)
            accepted = accepted or a["status"] != "FAILED"
        if accepted:
            self.errors = [e for e in self.errors if not any(e is other for other in earlier)]

    def fail(self, a, kind="INVALID_INSTANT_ACTION", until="instant"):
        a["status"] = "FAILED"
        self.errors.append((kind, "WARNING", until))

    def execute(self, a):
        kind = a["type"]
        allowed = self.automatic() or kind in ("stateRequest", "factsheetRequest")
        if self.mode == "INTERVENED" and not self.next_mode:
            allowed = kind in ("cancelOrder", "stateRequest", "factsheetRequest")
        if not allowed:
            self.fail(a)
        elif kind == "startPause":
            a["status"] = "RUNNING"
            self.pause(True)
        elif kind == "stopPause":
            self.pause(False)
            a["status"] = "FINISHED"
        elif kind == "cancelOrder":
            wanted = parameter_of(a["action"], "orderId")
            if not self.busy() or (wanted and wanted != self.order_id):
                return self.fail(a, "NO_ORDER_TO_CANCEL" if self.newer else "noOrderToCancel", "order")
            a["status"] = "RUNNING"
            if not self.clearing:
                self.begin_clearing()
        elif kind in ("stateRequest", "factsheetRequest") or (self.newer and kind == "clearInstantActions"):
            a["status"] = "FINISHED"
        elif self.newer and kind == "trigger":
            waiting = [w for w in self.running() if w["type"] == "waitForTrigger" and w["status"] == "RUNNING"]
            for w in waiting:
                w["status"] = "FINISHED"
            a["status"] = "FINISHED" if waiting else "FAILED"
        elif self.newer and kind in ("retry", "skipRetry"):
            wanted = parameter_of(a["action"], "actionId")
            failed = next((f for f in self.actions + self.instant if f["id"] == wanted), None)
            if failed is None or failed["status"] != "RETRIABLE":
                a["status"] = "FAILED"
            else:
                failed["status"] = "RUNNING" if kind == "retry" else "FAILED"
                a["status"] = "FINISHED"
                if kind == "retry":
                    self.errors = [e for e in self.errors if getattr(e, "action", None) != wanted]
        elif not can_execute(a["action"], "I", self.version):
            self.fail(a)
        else:
            self.begin(a)

    def apply(self, line):
        row, kind = None, line["kind"]
        if kind == "order":
            row = self.on_order(line["payload"])
        elif kind == "instant":
            self.on_instant(line["payload"])
        elif kind == "node":
            self.x = line["x"]
            self.on_node(line["sequence"])
        elif kind == "progress":
            self.on_progress(line["action"], line["status"], line.get("error"))
        elif kind == "drive":
            self.driving = line["driving"]
        elif kind == "mode":
            self.on_mode(line["mode"])
        elif kind == "pause":
            self.pause(line["paused"])
        elif kind == "error":
            self.errors = [e for e in self.errors if e[0] != "test"] + [("test", line["level"], "cause")]
        elif kind == "clear":
            self.errors = [e for e in self.errors if e[0] != "test"]
        self.settle()
        return row

    def after(self):
        states = [[a["id"], a["status"]] for a in self.actions]
        instant = [[a["id"], a["status"]] for a in self.instant]
        return {"order": [self.order_id, self.update_id], "last": list(self.last),
                "nodes": [[p["nodeId"], p["sequenceId"], p["released"]] for p in self.ahead() if "nodeId" in p],
                "edges": [[p["edgeId"], p["sequenceId"], p["released"]] for p in self.ahead() if "edgeId" in p],
                "actions": states if self.newer else states + instant, "instant": instant if self.newer else [],
                "mode": self.mode, "paused": self.paused, "driving": self.driving, "may": self.may_drive(),
                "errors": sorted({e[0] for e in self.errors}), "maps": self.maps}


class Error(tuple):
    """An error of a failed action: (type, level, until, id)."""
    @property
    def action(self):
        return self[3]

    def __iter__(self):
        return iter((self[0], self[1], self[2]))


# ------------------------------------------------------------------------------------------------ rules of the fleet

class Fleet:
    """Verdicts about orders, from the messages alone: what was sent, and the newest state."""
    def __init__(self, version):
        self.version, self.read_order = version, schema(version)[0]
        self.newest = {}  # update id by order, of those that count as sent
        self.state = None
        self.places = {}  # of the ids of actions, where each was used first
        self.ambiguous = set()  # ids of actions of orders that are instant actions, too

    def judge(self, line):
        if line["kind"] == "instant":
            try:
                message = schema(self.version)[1](parse(line["payload"]))
            except Bad:
                return {"message_form"}
            for action in message["actions"]:
                self.use(action["actionId"], "instant")
            return set()
        if line["kind"] != "order":
            return set()
        try:
            order = self.read_order(parse(line["payload"]))
        except Bad:
            return {"message_form"}
        if not has_form(order, self.version):
            return {"order_form"}
        for part in order["nodes"] + order["edges"]:
            for action in part["actions"]:
                self.use(action["actionId"], "order")
        found = set()
        state = self.state
        if state and state["mode"] not in ("AUTOMATIC", "SEMIAUTOMATIC", "INTERVENED"):
            found.add("orders_in_modes")
        if order["orderId"] in self.newest:
            if order["orderUpdateId"] < self.newest[order["orderId"]]:
                found.add("update_id_grows")
        else:
            if order["nodes"][0]["sequenceId"] != 0:
                found.add("order_begins_at_zero")
            if self.version == "3.0" and order["orderUpdateId"] != 0:
                found.add("new_order_update_zero")
            if state and (state["nodes"] or state["edges"] or
                          any(status not in FINAL and not self.is_instant(identity) and identity not in self.ambiguous
                              for identity, status in state["actions"])):
                found.add("new_order_when_idle")
        self.newest[order["orderId"]] = max(order["orderUpdateId"], self.newest.get(order["orderId"], 0))
        return found

    def use(self, identity, place):
        if self.places.setdefault(identity, place) != place:
            self.ambiguous.add(identity)

    def is_instant(self, identity):
        return self.places.get(identity) == "instant"


def main():
    program, first, count = sys.argv[1], sys.argv[2], sys.argv[3]
    process = subprocess.Popen([program, first, count], stdout=subprocess.PIPE, text=True, errors="surrogateescape")
    sequences, inputs, faults, rows, rules = 0, 0, [], {}, {}
    skip = False
    for text_line in process.stdout:
        line = json.loads(text_line)
        if "seed" in line:
            seed, version = line["seed"], line["version"]
            vehicle, fleet = Vehicle(version, line["stops"]), Fleet(version)
            sequences, step, skip = sequences + 1, 0, False
            continue
        inputs, step = inputs + 1, step + 1
        if skip:
            continue
        found = line["after"]
        fleet_verdicts = fleet.judge(line)
        row = vehicle.apply(line)
        expected = vehicle.after()
        expected["row"] = row
        found["errors"] = sorted(set(found["errors"]))
        expected["verdicts"] = sorted(fleet_verdicts)
        shown_verdicts = found["verdicts"]
        found["verdicts"] = sorted(set(found["verdicts"]) & FLEET_RULES)
        expected["broken"] = []
        differences = [key for key in expected if expected[key] != found[key]]
        if differences:
            skip = True  # what follows is different, too
            key = differences[0]
            faults.append(f"seed {seed} ({version}), input {step}, {line['kind']}: {key}: found {found[key]}, "
                          f"expected {expected[key]}; {line.get('payload', line)}")
            if len(faults) >= 10:
                process.kill()
                break
        if row:
            rows[row] = rows.get(row, 0) + 1
        for verdict in shown_verdicts:
            rules[verdict] = rules.get(verdict, 0) + 1
        fleet.state = found
    status = process.wait()
    for fault in faults:
        print(fault[:2000])
    print(f"{sequences} sequences, {inputs} inputs, {len(faults)} differences")
    print("rows:", rows)
    print("verdicts:", rules)
    sys.exit(1 if faults or status != 0 or sequences != int(count) else 0)


if __name__ == "__main__":
    main()
