// SPDX-License-Identifier: Apache-2.0
#include "report/values.h"

#include "platform/files.h"
#include "report/document.h"

namespace fourdvt::report {
namespace {

template <class Each>
void eachShown(const Values& values, Each each) {
  for (const Value& v : values)
    if (!v.title.empty()) each(v);
}

}  // namespace

Value::Value(std::string key, std::string title, Json value, std::string text)
    : key(std::move(key)), title(std::move(title)), value(std::move(value)), text(std::move(text)) {}

Value::Value(std::string key, std::string title, double value, int decimals)
    : Value(std::move(key), std::move(title), Json(value), fixedText(value, decimals)) {}

Value::Value(std::string key, std::string title, Json value)
    : key(std::move(key)),
      title(std::move(title)),
      value(std::move(value)),
      text(this->value.is_string() ? this->value.get<std::string>() : this->value.dump()) {}

Value::Value(std::string key, Json value) : key(std::move(key)), value(std::move(value)) {}

void append(Values& values, Values more) { std::move(more.begin(), more.end(), std::back_inserter(values)); }

Json jsonOf(const Values& values) {
  Json out = Json::object();
  for (const Value& v : values)
    if (!v.key.empty()) out[Json::json_pointer("/" + v.key)] = v.value;
  return out;
}

Json jsonOf(const std::vector<Values>& rows) {
  Json out = Json::array();
  for (const Values& row : rows) out.push_back(jsonOf(row));
  return out;
}

std::vector<Tile> tilesOf(const Values& values) {
  std::vector<Tile> out;
  eachShown(values, [&](const Value& v) { out.push_back({v.text, v.title}); });
  return out;
}

Table factsOf(const Values& values) {
  Table out{"", "", {"", "value"}, {}};
  eachShown(values, [&](const Value& v) { out.rows.push_back({v.title, v.text}); });
  return out;
}

Table tableOf(std::string title, std::string note, const std::vector<Values>& rows) {
  Table out{std::move(title), std::move(note), {}, {}};
  for (const Values& row : rows) {
    const bool is_first = out.rows.empty();
    std::vector<std::string>& cells = out.rows.emplace_back();
    eachShown(row, [&](const Value& v) {
      if (is_first) out.columns.push_back(v.title);
      cells.push_back(v.text);
    });
  }
  return out;
}

Status writeReport(const std::string& folder, const std::string& name, const Document& page, const Json& json) {
  FOURDVT_TRY(platform::writeFileAtomic(folder + "/" + name + ".html", documentHtml(page)));
  return platform::writeFileAtomic(folder + "/" + name + ".json",
                                   json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace fourdvt::report
