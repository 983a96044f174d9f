// Saving never destroys a file, and history returns to each text.
#include "viewer/editor/edited_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <cmath>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <nlohmann/json.hpp>

#include "tests/support/files.h"
#include "viewer/editor/edit_link.h"

namespace troupe {
namespace {

EditedFile Opened(const std::string& path, const std::string& initial = "") {
  Result<EditedFile> file = EditedFile::Open(path, initial);
  EXPECT_TRUE(file.ok()) << (file.ok() ? "" : file.error().ToString());
  return std::move(file).value();
}

TEST(EditedFileTest, SavedTextReplacesTheFileAsAWhole) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("a.world", "old\n");
  chmod(path.c_str(), 0640);
  EditedFile file = Opened(path);
  EXPECT_FALSE(file.is_modified({}));
  file.Change("new\n", "the change");
  EXPECT_TRUE(file.is_modified({}));
  EXPECT_EQ(folder.Read("a.world"), "old\n");
  ASSERT_TRUE(file.Save(false, {}).ok());
  EXPECT_EQ(folder.Read("a.world"), "new\n");
  EXPECT_FALSE(file.is_modified({}));
  struct stat status {};
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640U);
  EXPECT_EQ(folder.size(), 1U);
}

TEST(EditedFileTest, ALinkStaysALink) {
  const test::TemporaryFolder folder;
  folder.Write("a.world", "old\n");
  std::filesystem::create_symlink("a.world", folder / "link.world");
  EditedFile file = Opened(folder / "link.world");
  file.Change("new\n", "the change");
  ASSERT_TRUE(file.Save(false, {}).ok());
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.world"));
  EXPECT_EQ(folder.Read("a.world"), "new\n");
}

TEST(EditedFileTest, AFileThatHasChangedOnDiskIsKept) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("a.world", "old\n");
  EditedFile file = Opened(path);
  file.Change("mine\n", "the change");
  folder.Write("a.world", "theirs\n");
  const Status refused = file.Save(false, {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kNoRoom);
  EXPECT_EQ(folder.Read("a.world"), "theirs\n");
  ASSERT_TRUE(file.Reload().ok());
  EXPECT_EQ(file.text(), "theirs\n");
  file.Undo();
  EXPECT_EQ(file.text(), "mine\n");
  ASSERT_TRUE(file.Save(false, {}).ok());
  std::filesystem::remove(path);
  EXPECT_FALSE(file.Save(false, {}).ok());
  EXPECT_TRUE(file.Save(true, {}).ok());
}

TEST(EditedFileTest, ANewFileDoesNotReplaceOneThatAppeared) {
  const test::TemporaryFolder folder;
  EditedFile file = Opened(folder / "new.world", "");
  EXPECT_TRUE(file.is_modified({}));
  folder.Write("new.world", "theirs\n");
  EXPECT_FALSE(file.Save(false, {}).ok());
  EXPECT_EQ(folder.Read("new.world"), "theirs\n");
  EXPECT_FALSE(EditedFile::Open(folder / "none/new.world", "").ok());
}

// A write that fails half-way, as on a full disk.
TEST(EditedFileTest, AFullDiskLeavesTheFileAsItWas) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("a.world", "old\n");
  EditedFile file = Opened(path);
  file.Change(std::string(100'000, '#'), "the change");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 4096;
  setrlimit(RLIMIT_FSIZE, &small);
  const Status saved = file.Save(false, {});
  setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(saved.ok());
  EXPECT_EQ(saved.error().code, ErrorCode::kOutputFailed);
  EXPECT_EQ(folder.Read("a.world"), "old\n");
  EXPECT_EQ(folder.size(), 1U);
  EXPECT_TRUE(file.is_modified({}));
  EXPECT_TRUE(file.Save(false, {}).ok());
}

TEST(EditedFileTest, HistoryIsBounded) {
  const test::TemporaryFolder folder;
  EditedFile file = Opened(folder / "new.world", "");
  for (std::size_t i = 0; i < 2 * EditedFile::kMaxStates; ++i) file.Change(std::to_string(i), "edit");
  std::size_t undone = 0;
  for (; file.undo_label(); ++undone) file.Undo();
  EXPECT_EQ(undone, EditedFile::kMaxStates - 1);
}

class Watcher : public ObserverHandler {
 public:
  void OnSession(const SessionMessage& session) override {
    const std::lock_guard lock(mutex_);
    session_ = session;
    ++worlds_;
  }
  void OnFrame(const SharedFrame& frame) override {
    {
      const std::lock_guard lock(mutex_);
      frame_ = *frame;
    }
    changed_.notify_all();
  }
  void OnStatus(const StatusMessage&) override {}
  void OnServiceGone() override {}

  template <typename Condition>
  bool Await(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(60), [&] { return condition(session_, frame_); });
  }
  SessionMessage session() {
    const std::lock_guard lock(mutex_);
    return session_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  SessionMessage session_;
  FrameMessage frame_;
  int worlds_ = 0;
};

const char* const kHall = R"(define bridge model
(
  size [0.5 1 0.3]
  block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z [0.4 0.7] )
)
bridge( name "b" pose [1 0 0 0] )
position( name "r" pose [-3 0 0 0] size [0.3 0.3 0.3] )
)";

struct Edited {
  test::TemporaryFolder folder;
  std::unique_ptr<EditLink> link;
  Watcher watcher;
  std::unique_ptr<RunObservation> observation;

  explicit Edited(const std::string& text = kHall) {
    Result<std::unique_ptr<Editor>> editor = Editor::Open(folder.Write("hall.world", text));
    EXPECT_TRUE(editor.ok());
    link = std::make_unique<EditLink>(std::move(editor).value());
    observation = std::move(link->Observe(watcher)).value();
  }
  ~Edited() { observation.reset(); }

  ControlReply Ask(control::Request request) { return link->Ask(request).value(); }
  Result<nlohmann::json> Edit(const nlohmann::json& request) {
    const Result<EditOperation> operation = DecodeEditOperation(JsonReader::OfText(request.dump()));
    return operation.ok() ? link->Edit(operation.value()) : operation.error();
  }
};

TEST(EditLinkTest, StaticModelsAreShownAsObjectsAndMoveTheText) {
  Edited edited;
  EXPECT_EQ(edited.watcher.session().world->objects.size(), 1U);
  EXPECT_TRUE(Validate(edited.watcher.session().world).ok());
  control::SetPose move{.name = "b", .pose = {2.0, 0.0, 0.0, 0.0}};
  EXPECT_TRUE(edited.Ask(move).done);
  EXPECT_TRUE(edited.watcher.Await([](const SessionMessage& session, const FrameMessage& frame) {
    return session.world_edition == frame.world_edition && frame.state.objects[0].X_WO.x == 2.0 && frame.paused;
  }));
  EXPECT_TRUE(edited.link->has_unsaved_edits());
}

TEST(EditLinkTest, StaticModelsBeforeDoorsAndLiftsAreShownAtTheirPlaces) {
  Edited edited(R"(model( name "wall" pose [5 0 0 0] size [1 0.2 1] )
door( name "gate" pose [1 2 0 90] )
model( name "post" pose [6 0 0 0] size [0.2 0.2 1] )
lift
(
  name "hoist" pose [-4 3 0 0] floors ["a" "b"] heights [0 3]
  block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z [-0.1 0] )
)
)");
  const SessionMessage session = edited.watcher.session();
  const WorldDescription& world = *session.world;
  EXPECT_TRUE(Validate(session.world).ok());
  ASSERT_FALSE(world.doors.empty());
  ASSERT_FALSE(world.lifts.empty());
  EXPECT_TRUE(edited.watcher.Await([&](const SessionMessage&, const FrameMessage& frame) {
    if (frame.state.objects.size() != world.objects.size()) return false;
    bool is_right = true;
    for (std::size_t i = 0; i < world.objects.size(); ++i) {
      const ModelDescription& model = world.model(world.objects[i]);
      const Pose& expected = model.X_PM;
      const Pose& shown = frame.state.objects[i].X_WO;
      if (std::hypot(shown.x - expected.x, shown.y - expected.y) > 1.0) {
        ADD_FAILURE() << model.name << " is shown at " << shown.x << ", " << shown.y;
        is_right = false;
      }
    }
    return is_right;
  }));
}

TEST(EditLinkTest, ATestStepsTheModelAndLeavesTheFile) {
  for (const auto& [height, passes] : {std::pair(0.35, true), std::pair(0.45, false)}) {
    Edited edited;
    ASSERT_TRUE(edited.Edit({{"op", "test"}, {"model", "bridge"}, {"probe_height", height}}).ok());
    control::Step step{.ticks = 150};
    EXPECT_TRUE(edited.Ask(step).done);
    EXPECT_TRUE(edited.watcher.Await([passed = passes](const SessionMessage&, const FrameMessage& frame) {
      return frame.state.tick == 150 && (frame.state.robots[0].X_WR.x > 0.5) == passed;
    }));
    control::SetPose move{.name = "b"};
    EXPECT_FALSE(edited.Ask(move).done);
    ASSERT_TRUE(edited.Edit({{"op", "end_test"}}).ok());
    EXPECT_TRUE(edited.watcher.Await(
        [](const SessionMessage& session, const FrameMessage&) { return session.world->name == "hall.world"; }));
    EXPECT_FALSE(edited.link->has_unsaved_edits());
  }
}

TEST(EditLinkTest, MoreStepsThanItTakesAtOnceAreRefused) {
  Edited edited;
  control::Step step{.ticks = 1001};
  const ControlReply refused = edited.Ask(step);
  EXPECT_FALSE(refused.done);
  EXPECT_EQ(refused.problem, "found 1001 steps, expected at most 1000 at once");
  EXPECT_EQ(refused.tick, 0u);
  step.ticks = 1000;
  EXPECT_TRUE(edited.Ask(step).done);
}

TEST(EditLinkTest, TheWorldIsPlayedAndItsRobotsDriven) {
  Edited edited;
  control::Play play;
  EXPECT_EQ(edited.Ask(play).state, RunState::kPlaying);
  control::CommandRobot drive{.name = "r", .ticks = 5};
  drive.twist = Twist{0.5, 0.0, 0.0};
  EXPECT_TRUE(edited.Ask(drive).done);
  EXPECT_TRUE(edited.watcher.Await([](const SessionMessage&, const FrameMessage& frame) {
    return frame.state.tick > 10 && frame.state.robots[0].X_WR.x > -3.0 && frame.state.robots[0].twist.vx == 0.0;
  }));
  // An edit ends the test.
  ASSERT_TRUE(edited.Edit({{"op", "delete"}, {"name", "r"}}).ok());
  EXPECT_TRUE(edited.watcher.Await([](const SessionMessage& session, const FrameMessage& frame) {
    return session.world->robots.empty() && frame.paused;
  }));
}

TEST(EditLinkTest, AFileThatDoesNotExistYetHasNothingToLoseUntilAnEdit) {
  const test::TemporaryFolder folder;
  EditLink link(std::move(Editor::Open(folder / "new.world")).value());
  EXPECT_FALSE(link.has_unsaved_edits());
  const auto edit = [&](const nlohmann::json& request) {
    return link.Edit(DecodeEditOperation(JsonReader::OfText(request.dump())).value()).ok();
  };
  ASSERT_TRUE(edit({{"op", "set_text"}, {"text", "model( name \"wall\" )\n"}}));
  EXPECT_TRUE(link.has_unsaved_edits());
  ASSERT_TRUE(edit({{"op", "undo"}}));
  EXPECT_FALSE(link.has_unsaved_edits());
  ASSERT_TRUE(edit({{"op", "redo"}}));
  ASSERT_TRUE(edit({{"op", "save"}}));
  EXPECT_FALSE(link.has_unsaved_edits());
  ASSERT_TRUE(edit({{"op", "undo"}}));
  EXPECT_TRUE(link.has_unsaved_edits()) << "the file has the wall";
}

TEST(EditLinkTest, ATestOfAnUnknownModelIsRefused) {
  Edited edited;
  EXPECT_FALSE(edited.Edit({{"op", "test"}, {"model", "no"}}).ok());
  EXPECT_FALSE(edited.link->has_unsaved_edits());
}

}  // namespace
}  // namespace troupe
