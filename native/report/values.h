// SPDX-License-Identifier: Apache-2.0
// Figures of a report as one list, from which its JSON and the page's tables, tiles and facts are made.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "report/document.h"

namespace fourdvt::report {

using Json = nlohmann::ordered_json;

struct Value {
  Value(std::string key, std::string title, Json value, std::string text);
  Value(std::string key, std::string title, double value, int decimals);
  Value(std::string key, std::string title, Json value);  // as it is: a string or a whole number
  Value(std::string key, Json value);                     // not on the page

  std::string key;    // in JSON, "object/member" inside an object; empty: on the page alone
  std::string title;  // of the column, row or tile; empty: in JSON alone
  Json value;
  std::string text;
};
using Values = std::vector<Value>;

void append(Values& values, Values more);
// A list of values for every item.
template <class Items, class Make>
std::vector<Values> rowsOf(const Items& items, Make make) {
  std::vector<Values> rows;
  for (const auto& item : items) rows.push_back(make(item));
  return rows;
}

Json jsonOf(const Values& values);             // an object
Json jsonOf(const std::vector<Values>& rows);  // an array of objects
std::vector<Tile> tilesOf(const Values& values);
// A row each, title and text.
Table factsOf(const Values& values);
// Titles of the first row over the texts of all; no column without rows.
Table tableOf(std::string title, std::string note, const std::vector<Values>& rows);

// Writes FOLDER/NAME.html and FOLDER/NAME.json. Errors: WriteFailed.
Status writeReport(const std::string& folder, const std::string& name, const Document& page, const Json& json);

}  // namespace fourdvt::report
