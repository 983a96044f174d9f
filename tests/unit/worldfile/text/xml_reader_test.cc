// XML texts: places, references, and texts that are refused.
#include "worldfile/text/xml_reader.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/values.h"

namespace troupe {
namespace {

using test::ValueOf;

TEST(ParseXml, ReadsElementsWithTheirPlaces) {
  const XmlElement root =
      ValueOf(ParseXml("\xef\xbb\xbf<?xml version='1.0'?>\n<!DOCTYPE sdf>\n<!-- a > b -->\n<sdf version=\"1.6\">\n  <a "
                       "x='1' y=\"&lt;2&#65;\"/>\n"
                       "  <b>\n 3 <!-- c --> 4<![CDATA[<5>]]> </b>\n stray \\\n</sdf>\n",
                       "f.sdf"));
  EXPECT_EQ(root.name, "sdf");
  EXPECT_EQ(root.line, 4);
  ASSERT_EQ(root.children.size(), 2U);
  EXPECT_EQ(*root.Find("a")->FindAttribute("y"), "<2A");
  EXPECT_EQ(root.Find("a")->attributes[1].column, 12);
  EXPECT_EQ(root.Find("b")->Trimmed(), "3  4<5>");
  EXPECT_EQ(root.Find("b")->text_line, 7);
  EXPECT_EQ(root.Find("b")->text_column, 2);
  EXPECT_EQ(root.Find("c"), nullptr);
  EXPECT_EQ(root.Find("a")->FindAttribute("z"), nullptr);
}

struct BadXml {
  std::string text;
  std::string message;
};

const BadXml kBadXmls[] = {
    {"", "f:1:1: error: found the end of the file, expected an XML element"},
    {"text", "f:1:1: error: found 'text', expected an XML element"},
    {"<a>\n<b></a>", "f:2:4: error: found '</a>', expected '</b>' for the element of line 2"},
    {"<a>\n\n", "f:3:1: error: found the end of the file in element 'a' of line 1, expected '</a>'"},
    {"<a b></a>", "f:1:5: error: found '></a>', expected '=' and a value in quotes"},
    {"<a b=5></a>", "f:1:6: error: found '5></a>', expected a value in quotes"},
    {"<a b='5></a>", "f:1:6: error: found a value without its closing quote, expected one"},
    {"<a/>\n<b/>", "f:2:1: error: found '<b/>' after the root element, expected the end of the file"},
    {"<a>&b;</a>",
     "f:1:4: error: found the reference '&b;', expected one of XML's own: lt, gt, amp, quot, apos, or the number of a "
     "character"},
    {"<!DOCTYPE a [\n<!ENTITY b 'c'>\n]><a>&b;</a>",
     "f:2:1: error: found a declaration of an entity, expected none: entities are not read"},
    {std::string("<a>\0</a>", 8), "f:1:4: error: found a NUL byte, expected text"},
    {"<a><!-- </a>", "f:1:4: error: found a comment without its end, expected '-->'"},
};

TEST(ParseXml, RefusesOtherTexts) {
  for (const BadXml& bad : kBadXmls) {
    const Result<XmlElement> read = ParseXml(bad.text, "f");
    ASSERT_FALSE(read.ok()) << bad.text;
    EXPECT_EQ(read.error().ToString(), bad.message);
  }
}

TEST(ParseXml, LimitsDepthAndElements) {
  std::string deep;
  for (std::size_t i = 0; i <= kMaxXmlDepth; ++i) deep += "<a>";
  EXPECT_NE(ParseXml(deep, "f").error().message.find("elements inside each other"), std::string::npos);
  std::string many = "<a>";
  for (std::size_t i = 0; i <= kMaxXmlElements; ++i) many += "<b/>";
  EXPECT_NE(ParseXml(many + "</a>", "f").error().message.find("elements and attributes"), std::string::npos);
}

}  // namespace
}  // namespace troupe
