// EditLink: a file in editing, for the gateway as if it were a run: the edited world is a paused run, whose edits
// change the file. A test is a simulation in this process, of that world or of one model.
//
// So the page needs no second protocol: it shows, picks and moves things in an edited file by the same messages as in a
// run, and only edits of the text have operations of their own. Each edit that changes the world is another edition.
//
// In the edited world static models are shown as objects, so that the page can pick and move them.
//
// Threads: any; a thread of its own steps a test.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "troupe/simulation.h"
#include "viewer/editor/editor.h"
#include "viewer/gateway/viewer_gateway.h"

namespace troupe {

class EditLink final : public RunLink {
 public:
  explicit EditLink(std::unique_ptr<Editor> editor);
  ~EditLink() override;
  EditLink(const EditLink&) = delete;
  EditLink& operator=(const EditLink&) = delete;

  Result<std::unique_ptr<RunObservation>> Observe(ObserverHandler& handler) override;
  Result<ControlReply> Ask(const control::Request& request) override;
  Result<nlohmann::json> Edit(const EditOperation& operation) override;

  bool has_unsaved_edits() const;

 private:
  class Observation;
  // A robot of the test that a page drives, until its command expires.
  struct Driven {
    std::uint64_t ticks_left = 0;
  };

  void Forget(ObserverHandler& handler);
  void Run();
  // REQUIRES, of all below: mutex_ is held.
  // The edited world, at its initial state. It replaces a test in view.
  void ShowEdited();
  void ShowTest();
  // Counts an edition up, so that the gateway takes the world for another one.
  void PostWorld(const WorldDescription& world, const WorldState& state);
  void PostState(const WorldState& state, const std::vector<Event>& events);
  void PostAll();
  // `model`: empty: the whole world. `probe_height`: m, of the plain robot that is put beside a model that is no robot.
  Status StartTest(const std::string& model, double probe_height);
  // From the world as it was when the test began, whatever has been edited since.
  Status Restart();
  void EndTest();
  void StepTest();
  Status Drive(const control::CommandRobot& request);
  Status Apply(const control::Request& request, ControlReply& reply);
  // The requests of the page of an editor: about a test, then about the file.
  struct RequestOfPage;
  Result<nlohmann::json> Execute(const edit::Test& operation);
  Result<nlohmann::json> Execute(const edit::EndTest&);
  template <typename Operation>
  Result<nlohmann::json> Execute(const Operation& operation);

  const RunId run_;
  mutable std::mutex mutex_;  // guards all below but the thread
  std::condition_variable changed_;
  std::unique_ptr<Editor> editor_;
  std::uint64_t shown_version_ = 0;  // of the editor
  ObserverHandler* handler_ = nullptr;
  SessionMessage session_;
  FrameMessage frame_;
  Edition edition_ = 0;
  std::optional<WorldDescription> test_world_;  // as at the start of the test
  std::optional<Simulation> test_;
  std::string tested_;  // the model; empty: the world
  std::map<RobotId, Driven> driven_;
  bool playing_ = false;
  std::optional<double> speed_ = 1.0;  // multiple of real time; nothing: as fast as possible
  bool ending_ = false;
  std::thread thread_;  // last
};

}  // namespace troupe
