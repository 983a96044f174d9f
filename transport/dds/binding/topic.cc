#include "transport/dds/binding/topic.h"

namespace troupe::dds {
namespace {

dds_topic_descriptor_t WithoutTypeInformation(const dds_topic_descriptor_t& type) {
  return {.m_size = type.m_size,
          .m_align = type.m_align,
          .m_flagset = type.m_flagset & ~DDS_TOPIC_XTYPES_METADATA,
          .m_nkeys = type.m_nkeys,
          .m_typename = type.m_typename,
          .m_keys = type.m_keys,
          .m_nops = type.m_nops,
          .m_ops = type.m_ops,
          .m_meta = type.m_meta,
          .type_information = {},
          .type_mapping = {},
          .restrict_data_representation = type.restrict_data_representation};
}

}  // namespace

dds_entity_t CreateTopic(const DomainParticipant& participant, const dds_topic_descriptor_t& type,
                         const std::string& name) {
  const dds_topic_descriptor_t undescribed = WithoutTypeInformation(type);
  const dds_topic_descriptor_t* const announced = participant.describes_types() ? &type : &undescribed;
  return Check(dds_create_topic(participant.handle(), announced, name.c_str(), nullptr, nullptr),
               "creating topic '" + name + "'");
}

}  // namespace troupe::dds
