#include "transport/dds/binding/qos.h"

#include <gtest/gtest.h>

#include "transport/dds/transport/qos_profiles.h"

namespace troupe::dds {
namespace {

TEST(QosTest, HasThePoliciesThatWereSet) {
  Qos qos;
  qos << Reliability::Reliable(0.25) << History::KeepLast(3) << Durability::TransientLocal();
  dds_reliability_kind_t reliability;
  dds_duration_t blocking = 0;
  ASSERT_TRUE(dds_qget_reliability(qos.get(), &reliability, &blocking));
  EXPECT_EQ(DDS_RELIABILITY_RELIABLE, reliability);
  EXPECT_EQ(DDS_MSECS(250), blocking);
  dds_history_kind_t history;
  std::int32_t depth = 0;
  ASSERT_TRUE(dds_qget_history(qos.get(), &history, &depth));
  EXPECT_EQ(DDS_HISTORY_KEEP_LAST, history);
  EXPECT_EQ(3, depth);
  dds_durability_kind_t durability;
  ASSERT_TRUE(dds_qget_durability(qos.get(), &durability));
  EXPECT_EQ(DDS_DURABILITY_TRANSIENT_LOCAL, durability);
}

TEST(QosTest, LeavesOtherPoliciesAlone) {
  dds_history_kind_t history;
  std::int32_t depth = 0;
  EXPECT_FALSE(dds_qget_history((Qos() << Durability::Volatile()).get(), &history, &depth));
}

TEST(QosTest, CopiesAreIndependent) {
  const Qos first = Qos() << History::KeepLast(1);
  Qos second = first;
  EXPECT_EQ(first, second);
  second << History::KeepLast(2);
  EXPECT_FALSE(first == second);
  second = first;
  EXPECT_EQ(first, second);
}

TEST(DurationTest, AcceptsAnyNumberOfSeconds) {
  EXPECT_EQ(DDS_MSECS(1500), ToDuration(1.5));
  EXPECT_EQ(0, ToDuration(-1.0));
  EXPECT_EQ(DDS_INFINITY, ToDuration(kInfinite));
  EXPECT_EQ(DDS_INFINITY, ToDuration(1e300));
  EXPECT_EQ(kInfinite, ToSeconds(DDS_INFINITY));
  EXPECT_DOUBLE_EQ(1.5, ToSeconds(DDS_MSECS(1500)));
}

// Cyclone leaves defaults out of its announcements, and some peers then cannot read them.
TEST(QosProfilesTest, NeverUseTheDefaultBlockingTime) {
  using namespace qos_profiles;
  for (const Qos& qos : {Description(1.0), Join(1.0), Admission(), Frame(), Proposal(), qos_profiles::Status()}) {
    dds_reliability_kind_t kind;
    dds_duration_t blocking = 0;
    ASSERT_TRUE(dds_qget_reliability(qos.get(), &kind, &blocking));
    EXPECT_EQ(DDS_RELIABILITY_RELIABLE, kind);
    EXPECT_NE(DDS_MSECS(100), blocking);
  }
}

}  // namespace
}  // namespace troupe::dds
