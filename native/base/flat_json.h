// SPDX-License-Identifier: Apache-2.0
// JSON as a flat table from JSON pointer ("/extensions/X/sequences/0/frames") to number, string or boolean. Pages
// flatten with JSON.parse, native tools with nlohmann/json; the portable manifest reader takes only this table, so that
// both share one validation and the player needs no JSON parser. Empty arrays and objects are not in the table.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace fourdvt {

class FlatJson {
 public:
  using Value = std::variant<double, std::string, bool>;
  void set(std::string pointer, Value value) { values_[std::move(pointer)] = std::move(value); }
  std::optional<double> number(const std::string& pointer) const {
    auto it = values_.find(pointer);
    if (it == values_.end() || !std::holds_alternative<double>(it->second)) return std::nullopt;
    return *std::get_if<double>(&it->second);
  }
  std::optional<std::string> string(const std::string& pointer) const {
    auto it = values_.find(pointer);
    if (it == values_.end() || !std::holds_alternative<std::string>(it->second)) return std::nullopt;
    return *std::get_if<std::string>(&it->second);
  }
  std::optional<bool> boolean(const std::string& pointer) const {
    auto it = values_.find(pointer);
    if (it == values_.end() || !std::holds_alternative<bool>(it->second)) return std::nullopt;
    return *std::get_if<bool>(&it->second);
  }
  // Returns true if an entry lies at or below the pointer.
  bool has(const std::string& pointer) const {
    auto it = values_.lower_bound(pointer);
    return it != values_.end() &&
           (it->first == pointer || it->first.compare(0, pointer.size() + 1, pointer + "/") == 0);
  }
  size_t size() const { return values_.size(); }

 private:
  std::map<std::string, Value> values_;
};

}  // namespace fourdvt
