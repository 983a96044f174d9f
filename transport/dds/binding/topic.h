// Topic<T>: a name and a type that writers and readers share. T is a C struct that idlc made;
// transport/dds/convert/topic_types.h lists ours.
#pragma once

#include <string>

#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/exception.h"

namespace troupe::dds {

// Decides which samples enter the readers of a topic, before they are decoded and stored.
class SampleFilter {
 public:
  virtual ~SampleFilter() = default;
  // Of a sample by the writer with this handle. Called on threads of Cyclone, while it has locked a reader.
  virtual bool Accepts(dds_instance_handle_t publication) const = 0;
};

// Specialised by TROUPE_DDS_TYPE for each type.
template <typename T>
struct TopicTraits;

// Creates the topic of a participant that describes its types or does not. Throws Exception.
dds_entity_t CreateTopic(const DomainParticipant& participant, const dds_topic_descriptor_t& type,
                         const std::string& name);

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
