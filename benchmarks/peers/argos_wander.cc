// A controller for foot-bots of ARGoS 3, by the rule of Troupe's `wander`: ahead until something is near, then a turn
// on the spot to the side with more room until the way is clear.
#include <argos3/core/control_interface/ci_controller.h>
#include <argos3/plugins/robots/foot-bot/control_interface/ci_footbot_proximity_sensor.h>
#include <argos3/plugins/robots/generic/control_interface/ci_differential_steering_actuator.h>

#include <cmath>

namespace {

constexpr double kSpeed = 10.0;       // cm/s, ahead
constexpr double kWheelSpeed = 5.6;   // cm/s, in a turn: 0.8 rad/s with wheels 14 cm apart
constexpr double kNear = 0.11;        // a sensor's reading at 0.09 m; it is 0 without an obstacle, and 1 at one
constexpr double kFrontAngle = 0.5;   // rad: bearings within this are ahead
constexpr double kSideAngle = 1.571;  // rad: bearings within this count for the choice of the side

}  // namespace

class WanderingFootBot : public argos::CCI_Controller {
 public:
  void Init(argos::TConfigurationNode&) override {
    wheels_ = GetActuator<argos::CCI_DifferentialSteeringActuator>("differential_steering");
    proximity_ = GetSensor<argos::CCI_FootBotProximitySensor>("footbot_proximity");
  }

  void ControlStep() override {
    bool front_is_clear = true;
    double balance = 0.0;  // below 0: more room to the left
    for (const auto& reading : proximity_->GetReadings()) {
      const double bearing = reading.Angle.GetValue();
      if (std::abs(bearing) <= kFrontAngle && reading.Value > kNear) front_is_clear = false;
      if (std::abs(bearing) <= kSideAngle) balance += bearing > 0.0 ? reading.Value : -reading.Value;
    }
    if (front_is_clear) {
      side_ = 0.0;
      wheels_->SetLinearVelocity(kSpeed, kSpeed);
      return;
    }
    if (side_ == 0.0) side_ = balance <= 0.0 ? 1.0 : -1.0;
    wheels_->SetLinearVelocity(-side_ * kWheelSpeed, side_ * kWheelSpeed);
  }

 private:
  argos::CCI_DifferentialSteeringActuator* wheels_ = nullptr;
  argos::CCI_FootBotProximitySensor* proximity_ = nullptr;
  double side_ = 0.0;  // 1: to the left, -1: to the right, 0: not turning
};

// The macro names classes of its own namespace.
using argos::CCI_Controller;
REGISTER_CONTROLLER(WanderingFootBot, "wandering_foot_bot")
