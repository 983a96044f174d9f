#!/usr/bin/python3
"""`troupe fleet check` on logs and at a real broker: each rule is broken by one conversation and by no good one, hostile
messages are violations and nothing worse, and a broker may go and come again.

usage: fleet_check_test.py FLEET_SEQUENCES --programs FOLDER
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

import paho.mqtt.client as mqtt

HERE = pathlib.Path(__file__).resolve()
sys.path.insert(0, str(HERE.parent))
from mqtt_broker import SECONDS, Broker, Listener, free_port  # noqa: E402

LINE = re.compile(r"^(\S+): ([a-z0-9_]+): (\S+), (\w+): found (.*), expected (.*)$")


class Publisher:
    """Publishes messages in order, each once it is at the broker."""
    def __init__(self, broker, **tls):
        self.client = mqtt.Client()
        if tls:
            self.client.tls_set(**tls)
        self.client.connect("127.0.0.1", broker.port)
        self.client.loop_start()

    def publish(self, topic, payload, retain=False):
        self.client.publish(topic, payload, qos=1, retain=retain).wait_for_publish(SECONDS)

    def play(self, log):
        for line in log:
            message = json.loads(line)
            self.publish(message["topic"], message["payload"])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.client.disconnect()
        self.client.loop_stop()


def run(troupe, *arguments):
    done = subprocess.run([troupe, "fleet", "check", *map(str, arguments)], capture_output=True, text=True, timeout=SECONDS, check=False)
    return done.returncode, done.stdout, done.stderr


def broken_rules(text):
    return {found.group(2) for found in map(LINE.match, text.splitlines()) if found}


TIMED = {"state_interval", "order_answered", "instant_action_reported", "zone_set_answered"}  # others' later messages would break these


def check_logs(troupe, folder, conversations):
    """The short conversations of a version are one log, each with a vehicle of its own; the others have logs of their own."""
    logs = {}
    for number, conversation in enumerate(conversations):
        rule = conversation["rule"]
        is_short = rule is not None and rule not in TIMED
        name = conversation["version"] if is_short else f"{conversation['version']}-{rule}"
        lines, expected = logs.setdefault(name, ([], {}))
        vehicle = f"anna{number}"
        lines += [line.replace("/anna/", f"/{vehicle}/").replace('\\"anna\\"', f'\\"{vehicle}\\"') for line in conversation["log"]]
        expected[f"Troupe/{vehicle}"] = {rule} if conversation["broken"] else set()
    broken = 0
    for name, (lines, expected) in logs.items():
        path, junit = folder / f"{name}.jsonl", folder / f"{name}.xml"
        path.write_text("".join(sorted(lines, key=lambda line: json.loads(line)["time"])))
        status, output, errors = run(troupe, path, "--junit", junit)
        assert not errors, errors
        found = {vehicle: set() for vehicle in expected}
        for line in filter(None, map(LINE.match, output.splitlines())):
            found[line.group(3).rstrip(",")].add(line.group(2))
        assert found == expected, f"{name}: " + "; ".join(f"{each}: found {found[each]}, expected {expected[each]}" for each in expected
                                                           if found[each] != expected[each])
        rules = sorted(set().union(*expected.values()))
        assert status == (1 if rules else 0), f"{name}: {status}"
        assert all(f"{vehicle} ({name[:3]}): " in output for vehicle in expected), output
        for suite in xml.etree.ElementTree.parse(junit).getroot():
            failed = {case.get("name") for case in suite if case.find("failure") is not None}
            assert failed == expected.get(suite.get("name"), set()), (suite.get("name"), failed)
        status, output, errors = run(troupe, path, *[f"--without={rule}" for rule in rules])
        assert status == 0 and not broken_rules(output), output
        broken += len([each for each in expected.values() if each])
    assert len(conversations) == 3 * 50 and broken >= 120, (len(conversations), broken)


def check_files(troupe, folder, good):
    path = folder / "log.jsonl"
    path.write_text("".join(good))
    assert run(troupe, path, "--interface", "uagv")[0] == 0
    status, _, errors = run(troupe, path, "--interface", "other")
    assert status == 2 and "found no message of VDA 5050" in errors, errors
    path.write_text("".join(good) + "{}\n")
    status, _, errors = run(troupe, path)
    assert status == 2 and errors.startswith(f"{path}:{len(good) + 1}:1: error: found no 'time'"), errors
    for arguments, text in [((), "error: found neither FILE nor --vda5050"), ((path, "--vda5050", "mqtt://localhost"), "error: "),
                            (("--vda5050", "http://localhost"), "error: --vda5050: "), ((folder / "none",), "No such file"),
                            ((path, "--for", "1"), "error: "), ((path, "--junit", path), "error: --junit"),
                            ((path, "--without", "none"), "error: --without"), ((path, "--junit", "/no/such/file"), "No such file")]:
        status, output, errors = run(troupe, *arguments)
        assert status == 2 and text in errors and errors.count("\n") == 1 and not output, (arguments, status, errors)
    # By the program that the manual names, of a message whose text is not one line.
    with Broker(folder) as broker, Publisher(broker) as publisher:
        publisher.publish("uagv/v2/Troupe/anna/connection", json.dumps(json.loads(json.loads(good[0])["payload"]), indent=1), retain=True)
        log = subprocess.run(["mosquitto_sub", "-h", "127.0.0.1", "-p", str(broker.port), "-t", "uagv/#", "-C", "1", "-F", "%j"],
                             capture_output=True, timeout=SECONDS, check=True).stdout
    path.write_bytes(log)
    status, output, errors = run(troupe, path)
    assert status == 0 and "1 vehicle, 1 message, 0 violations" in output, (output, errors)


def hostile_payloads():
    state = {"headerId": 1, "timestamp": "2026-11-28T08:00:00.00Z", "version": "2.1.0", "manufacturer": "Acme", "serialNumber": "evil"}
    yield b""
    yield b"not JSON"
    yield b"\xff\xfe\x00{"
    yield json.dumps(state).encode()[:-1] + b', "orderId": "\xc3\x28"}'
    yield b"[" * 100_000
    yield b'{"a":' * 50_000 + b"1" + b"}" * 50_000
    yield b"{" + b'"a": 1, ' * 3 + b'"a": 1}'
    yield json.dumps(state | {"errors": [{"errorType": "x", "errorLevel": "WARNING"}] * 1000}).encode()
    yield b'{"headerId": 1e999, "x": NaN}'
    yield b'{"headerId": -1}'
    yield b"null"
    yield json.dumps(state | {"padding": "x" * (10 << 20)}).encode()
    yield b"\x1b[2J\n" * 10


def check_broker(troupe, folder, conversations, good):
    topic = "uagv/v2/Acme/evil/state"
    with Broker(folder) as broker:
        address = ("--vda5050", broker.url)
        status, _, errors = run(troupe, *address, "--for", "0.3")
        assert status == 3 and "found no message of VDA 5050" in errors, (status, errors)
        with Publisher(broker) as publisher:
            log, junit = folder / "heard.jsonl", folder / "heard.xml"
            with Listener(troupe, "fleet", "check", *address, "--log", log, "--junit", junit) as checker:
                checker.wait_for("listening at ")
                publisher.publish("other/topic", "other")
                publisher.play(good)
                # Its last message is a violation, so that the line says when all have been judged.
                publisher.publish("uagv/v2/Acme/last/state", "{}")
                checker.wait_for("Acme/last")
                status, lines = checker.finish()
            assert status == 1 and broken_rules("\n".join(lines)) == {"message_form"}, lines
            assert any(line.startswith("Troupe/anna (2.1): ") and line.endswith("no violation") for line in lines), lines
            text = log.read_text()
            assert len(text.splitlines()) == len(good) + 1, text
            log.write_text("".join(text.splitlines(keepends=True)[:-1]))
            assert run(troupe, log)[0] == 0
            suites = xml.etree.ElementTree.parse(junit).getroot()
            assert {suite.get("name"): suite.get("failures") for suite in suites} == {
                "Acme/last": "1", "Troupe/anna": "0", "Troupe/bela": "0"}, junit.read_text()

            # A retained message is judged, too; a broken rule is seen as it is in a log; hostile messages end nothing.
            publisher.publish("uagv/v3/Acme/odd/connection", json.loads(good[0])["payload"].replace("anna", "odd"), retain=True)
            plan = next(each for each in conversations if each["rule"] == "cancel_clears" and each["version"] == "2.1")
            with Listener(troupe, "fleet", "check", *address, "--payloads") as checker:
                checker.wait_for("version_of_topic")
                publisher.play(plan["log"])
                checker.wait_for("cancel_clears: Troupe/anna, state: found")
                count = 0
                for payload in hostile_payloads():
                    publisher.publish(topic, payload)
                    checker.wait_for("message_form: Acme/evil, state: found ")
                    count += 1
                status, lines = checker.finish()
            assert status == 1 and not any("\x1b" in line for line in lines), lines
            assert any(f"message_form {count}" in line for line in lines if line.startswith("Acme/evil")), lines[-4:]
            assert any(line.startswith("  {") and '"orderId"' in line for line in lines), "no payload is printed"

        # The broker goes, and comes again.
        with Listener(troupe, "fleet", "check", *address) as checker:
            checker.wait_for("version_of_topic")
            broker.stop()
            checker.wait_for("warning: no connection to ")
            broker.start()
            checker.wait_for("listening at ")
            with Publisher(broker) as publisher:
                publisher.publish(topic, "{}")
            checker.wait_for("message_form")
            status, lines = checker.finish()
        assert status == 1, lines
    status, _, errors = run(troupe, *address, "--for", "5")
    assert status == 3 and f"cannot connect to {broker.url}" in errors, errors


def check_tls(troupe, folder):
    def openssl(*words):
        subprocess.run(["openssl", *words], cwd=folder, capture_output=True, check=True)

    key = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2")
    for name in ("ca", "other"):
        openssl("req", "-x509", *key, "-keyout", f"{name}.key", "-out", f"{name}.crt", "-subj", f"/CN={name}")
    openssl("req", *key, "-keyout", "server.key", "-out", "server.csr", "-subj", "/CN=127.0.0.1")
    (folder / "names").write_text("subjectAltName=IP:127.0.0.1\n")
    openssl("x509", "-req", "-in", "server.csr", "-CA", "ca.crt", "-CAkey", "ca.key", "-CAcreateserial", "-days", "2", "-extfile", "names",
            "-out", "server.crt")
    with Broker(folder, tls=folder) as broker:
        with Publisher(broker, ca_certs=str(folder / "ca.crt")) as publisher:
            publisher.publish("uagv/v2/Acme/evil/state", "{}", retain=True)
        status, output, errors = run(troupe, "--vda5050", broker.url, "--vda5050-ca", folder / "ca.crt", "--for", "0.5")
        assert status == 1 and broken_rules(output) == {"message_form"}, (status, output, errors)
        status, output, errors = run(troupe, "--vda5050", broker.url, "--vda5050-ca", folder / "other.crt", "--for", "5")
        assert status == 3 and "cannot connect to mqtts://" in errors, (status, errors)
        # Vehicles, too.
        for authority, expected in (("ca.crt", 0), ("other.crt", 3)):
            done = subprocess.run([troupe, "run", HERE.parents[2] / "worlds/scenarios/vda5050.json", "--vda5050", broker.url, "--vda5050-ca",
                                   folder / authority, "--in-process", "--headless", "--ticks", "3"], capture_output=True, text=True,
                                  timeout=SECONDS, check=False)
            assert done.returncode == expected, done
        assert "has accepted 0 of 2 vehicles in 10.2 s: " in done.stderr and "TLS" in done.stderr, done.stderr


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("sequences")
    parser.add_argument("--programs", required=True)
    arguments = parser.parse_args()
    troupe = os.path.join(arguments.programs, "troupe")
    output = subprocess.run([arguments.sequences, "--conversations"], capture_output=True, text=True, check=True).stdout
    conversations = [json.loads(line) for line in output.splitlines()]
    good = next(each["log"] for each in conversations if each["rule"] is None and each["version"] == "2.1")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_logs(troupe, folder, conversations)
        check_files(troupe, folder, good)
        check_broker(troupe, folder, conversations, good)
        check_tls(troupe, folder)
    print(f"{len(conversations)} conversations, a broker and TLS")


main()
