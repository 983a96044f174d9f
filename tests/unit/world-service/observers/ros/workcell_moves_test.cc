#include "world-service/observers/ros/workcell_moves.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/files.h"
#include "tests/support/values.h"
#include "troupe/world_state.h"
#include "world-service/core/step.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

constexpr const char* kWorld = R"(
position ( name "carrier" pose [0 0 0 0] size [0.4 0.4 0.3] )
position ( name "stand" pose [5 0 0 0] size [0.4 0.4 0.3] )
model ( name "can" pose [5 1 0 0] size [0.1 0.1 0.2] gripper_return 1 )

)";

class WorkcellMoves : public testing::Test {
 protected:
  WorkcellMoves() {
    folder_.Write("cells.world", kWorld);
    LoadedWorld loaded = test::ValueOf(LoadWorld(folder_.Path("cells.world"), {}));
    loaded.world.places = {{"first", "", {"dispenser:stand", "ingestor:bay"}, {5.0, 0.0, 0.0, 0.0}},
                           {"bay", "", {"ingestor:bay"}, {0.0, -1.0, 0.0, 0.0}}};
    scene_ = std::make_shared<const Scene>(std::move(loaded.world));
    state_ = InitialState(*scene_);
    workcells_ = FindWorkcells(scene_->world());
  }
  Pose& PoseOfRobot(const std::string& name) {
    return state_.robots[FindRobot(scene_->world(), name).value().index()].X_WR;
  }
  Result<ItemMove> Plan(const Workcell& workcell) { return PlanMove(scene_, state_, workcell, {}, {}); }

  test::TemporaryFolder folder_;
  std::shared_ptr<const Scene> scene_;
  WorldState state_;
  std::vector<Workcell> workcells_;
};

TEST_F(WorkcellMoves, TheWorkcellMovesWithItsBody) {
  ASSERT_EQ(workcells_.size(), 2u);
  EXPECT_FALSE(Plan(workcells_[0]).ok()) << "no robot but the body itself is near";
  PoseOfRobot("stand") = {1.0, 0.0, 0.0, 0.0};
  state_.objects[0].X_WO = {1.0, 1.0, 0.0, 0.0};
  const ItemMove move = test::ValueOf(Plan(workcells_[0]));
  EXPECT_EQ(move.item, "can");
  EXPECT_NEAR(move.X_WO.x, 0.0, 1e-9) << "on the carrier";
  EXPECT_NEAR(move.X_WO.z, 0.3, 1e-9);
}

TEST_F(WorkcellMoves, ThePlaceWithTheNameOfTheWorkcellCounts) {
  ASSERT_EQ(workcells_.size(), 2u);
  EXPECT_EQ(workcells_[1].name, "bay");
  EXPECT_EQ(workcells_[1].kind, WorkcellKind::kIngestor);
  EXPECT_EQ(workcells_[1].X_WN.y, -1.0);
}

}  // namespace
}  // namespace troupe
