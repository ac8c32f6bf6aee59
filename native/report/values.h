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
  Value(std::string key, std::string title, Json value);  // Json: a string or an integer, printed unchanged
  Value(std::string key, Json value);                     // absent from the page

  std::string key;    // JSON key, "object/member" inside an object; empty: on the page only
  std::string title;  // title of the column, row or tile; empty: in JSON only
  Json value;
  std::string text;
};
using Values = std::vector<Value>;

void append(Values& values, Values more);
// Values of every item.
template <class Items, class Make>
std::vector<Values> rowsOf(const Items& items, Make make) {
  std::vector<Values> rows;
  for (const auto& item : items) rows.push_back(make(item));
  return rows;
}

Json jsonOf(const Values& values);             // JSON object
Json jsonOf(const std::vector<Values>& rows);  // JSON array of objects
std::vector<Tile> tilesOf(const Values& values);
// Table with one row per value: title and text.
Table factsOf(const Values& values);
// Table with the first row's titles as header and the texts of all rows; columns without rows are dropped.
Table tableOf(std::string title, std::string note, const std::vector<Values>& rows);

// Writes FOLDER/NAME.html and FOLDER/NAME.json. Errors: WriteFailed.
Status writeReport(const std::string& folder, const std::string& name, const Document& page, const Json& json);

}  // namespace fourdvt::report
