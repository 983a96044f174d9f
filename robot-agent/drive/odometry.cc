#include "robot-agent/drive/odometry.h"

namespace troupe {

void Odometry::Update(const Pose& X_WR) {
  if (localization_->type == LocalizationType::kGps) {
    estimate_ = X_WR;
    return;
  }
  if (!started_) {
    started_ = true;
    estimate_ = localization_->origin;
  } else if (!(X_WR == last_X_WR_)) {
    Pose motion = Inverse(last_X_WR_) * X_WR;  // executed, not commanded: a stalled robot counts no motion
    motion.x *= 1.0 + localization_->error_x;
    motion.y *= 1.0 + localization_->error_y;
    motion.heading = WrapAngle(motion.heading * (1.0 + localization_->error_heading));
    estimate_ = estimate_ * motion;
  }
  last_X_WR_ = X_WR;
}

}  // namespace troupe
