// What is generated from declarations: tables, README sections, schemas.

#include <gtest/gtest.h>

#include "json_reader.h"
#include "params/document.h"
#include "zoo.h"

namespace brume {
namespace {

TEST(Document, AMarkdownTableHasOneRowPerParameter) {
  const auto specs = specs_of<Zoo>();
  const std::string table = markdown_table(specs);
  EXPECT_NE(table.find("| `density` | `0.002` | 0 to 10 per m | Extinction. |\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("Accuracy. Set from `tolerance` unless given."),
            std::string::npos);
  // A bar in a text must not end its cell: every row has five bars of its own.
  for (std::size_t at = 0, end; at < table.size(); at = end + 1) {
    end = table.find('\n', at);
    int bars = 0;
    for (std::size_t i = at; i < end; ++i)
      bars += table[i] == '|' && (i == at || table[i - 1] != '\\');
    EXPECT_EQ(bars, 5) << table.substr(at, end - at);
  }
}

TEST(Document, ATextTableKeepsToItsWidth) {
  const auto specs = specs_of<Zoo>();
  const std::string table = text_table(specs, 100);
  for (const ParamSpec& s : specs)
    EXPECT_NE(table.find(s.name), std::string::npos) << s.name;
  for (std::size_t at = 0, end; at < table.size(); at = end + 1) {
    end = table.find('\n', at);
    EXPECT_LE(end - at, 100u) << table.substr(at, end - at);
  }
}

TEST(Document, AGeneratedSectionIsReplacedAndNothingElse) {
  const std::string file =
      "# Fog\n<!-- generated: parameters -->\nold\nold\n<!-- end -->\nrest\n"
      "<!-- generated: errors -->\nkept\n<!-- end -->\n";
  const std::string once = replace_generated(file, "parameters", "new\n");
  EXPECT_EQ(once,
            "# Fog\n<!-- generated: parameters -->\nnew\n<!-- end -->\nrest\n"
            "<!-- generated: errors -->\nkept\n<!-- end -->\n");
  EXPECT_EQ(replace_generated(once, "parameters", "new"), once) << "fresh stays fresh";
  EXPECT_THROW(replace_generated(file, "pictures", "x"), Error);
  EXPECT_THROW(replace_generated("<!-- generated: a -->\n", "a", "x"), Error);
}

TEST(Document, TheSchemaOfAStageIsJsonAndKnowsEveryParameter) {
  const auto specs = specs_of<Zoo>();
  const std::string schema = json_schema("zoo", specs);
  EXPECT_TRUE(is_json(schema)) << schema;
  EXPECT_NE(schema.find("https://json-schema.org/draft/2020-12/schema"),
            std::string::npos);
  for (const ParamSpec& s : specs)
    EXPECT_NE(schema.find("\"" + s.name + "\": {\"description\""), std::string::npos);
  EXPECT_EQ(schema.find("inf"), std::string::npos) << "JSON has no infinity";
}

}  // namespace
}  // namespace brume
