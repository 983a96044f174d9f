// DomainParticipant: a participant in a DDS domain, with a configuration of its own; and the publishers, subscribers
// and topics of it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "transport/dds/binding/domain_config.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/qos.h"

namespace troupe::dds {

// Cyclone's threads and sockets, and the number by which the process knows the domain.
struct SharedDomain {
  std::shared_ptr<const Entity> entity;
  std::uint32_t number = 0;
};

class DomainParticipant {
 public:
  // Throws Exception: no such network interface, ports in use, out of resources, unreadable keys.
  explicit DomainParticipant(const DomainConfig& config, const Qos& qos = Qos());

  GuidPrefix guid_prefix() const;
  bool describes_types() const { return describes_types_; }
  dds_entity_t handle() const { return participant_.handle(); }

 private:
  SharedDomain domain_;  // ends after the participant
  Entity participant_;
  const bool describes_types_;
};

// Publisher and Subscriber: give writers and readers their partition.

class Publisher {
 public:
  explicit Publisher(const DomainParticipant& participant, const Qos& qos = Qos())
      : entity_(Check(dds_create_publisher(participant.handle(), qos.get(), nullptr), "creating a publisher")) {}
  dds_entity_t handle() const { return entity_.handle(); }

  // Waits until all samples of its writers are acknowledged, for this time at most for all of them.
  void AwaitAcknowledgments(double seconds) const noexcept;

 private:
  Entity entity_;
};

class Subscriber {
 public:
  explicit Subscriber(const DomainParticipant& participant, const Qos& qos = Qos())
      : entity_(Check(dds_create_subscriber(participant.handle(), qos.get(), nullptr), "creating a subscriber")) {}
  dds_entity_t handle() const { return entity_.handle(); }

 private:
  Entity entity_;
};

// Decides which samples enter the readers of a topic, before they are decoded and stored.
class SampleFilter {
 public:
  virtual ~SampleFilter() = default;
  // Whether a sample by the writer with this handle is accepted. Called on threads of Cyclone, while it has locked a
  // reader.
  virtual bool Accepts(dds_instance_handle_t publication) const = 0;
};

// Specialised by TROUPE_DDS_TYPE for each type.
template <typename T>
struct TopicTraits;

// Creates the topic of a participant that describes its types or does not. Throws Exception.
dds_entity_t CreateTopic(const DomainParticipant& participant, const dds_topic_descriptor_t& type,
                         const std::string& name);

// Topic<T>: a name and a type that writers and readers share. T is a C struct that idlc made;
// transport/dds/convert/convert.h lists ours.
template <typename T>
class Topic {
 public:
  Topic(const DomainParticipant& participant, const std::string& name)
      : name_(name), entity_(CreateTopic(participant, *TopicTraits<T>::descriptor(), name)) {}
  // REQUIRES: the filter outlives the readers of this object.
  Topic(const DomainParticipant& participant, const std::string& name, const SampleFilter& filter)
      : Topic(participant, name) {
    dds_topic_filter settings{};
    settings.mode = DDS_TOPIC_FILTER_SAMPLEINFO_ARG;
    settings.f.sampleinfo_arg = [](const dds_sample_info_t* info, void* argument) {
      return static_cast<const SampleFilter*>(argument)->Accepts(info->publication_handle);
    };
    settings.arg = const_cast<SampleFilter*>(&filter);
    Check(dds_set_topic_filter_extended(entity_.handle(), &settings), "setting the filter of topic '" + name + "'");
  }

  const std::string& name() const { return name_; }
  std::string type_name() const { return TopicTraits<T>::descriptor()->m_typename; }
  dds_entity_t handle() const { return entity_.handle(); }

 private:
  std::string name_;
  Entity entity_;
};

}  // namespace troupe::dds

// Makes a type of idlc's known to Topic, DataWriter and DataReader. Use outside of namespaces.
#define TROUPE_DDS_TYPE(type)                                                  \
  template <>                                                                  \
  struct troupe::dds::TopicTraits<type> {                                      \
    static const dds_topic_descriptor_t* descriptor() { return &type##_desc; } \
  }
