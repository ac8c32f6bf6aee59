// SPDX-License-Identifier: Apache-2.0
// A strict command line, declared as rows: an option's name, the field that it sets with the range, and one sentence.
// Help, parser, range check and messages come from the rows; the first problem is kept as one line. Order of calls:
// construct, which sets all fields → complain about combinations → helpOrProblem().
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/result.h"

namespace fourdvt::tools {

// Program name in messages; "fourdvt" by default.
const char* programName();
void setProgramName(const char* name);

constexpr int kOk = 0, kFailed = 1, kUsage = 2, kInterrupted = 130;
// Prints "PROGRAM: MESSAGE" and returns the exit code of the error.
int fail(const Error& error);

class Args;
// Sets a field from the option `name`. Called once per command line, in the order of the rows; a field keeps its
// default if the option is absent.
using Reader = std::function<void(Args&, const std::string& name)>;

struct Option {
  std::string form;      // "--layers N", "-o FOLDER"; without a value, a flag: "--resume"
  Reader read;           // one of the functions below, or a custom one
  std::string meaning;   // with default and unit; the help breaks it into lines
  bool repeats = false;  // may occur several times
};
using Options = std::vector<Option>;

Options join(std::initializer_list<Options> parts);

struct Syntax {
  std::string usage;                      // "bake CAPTURE -o CHARACTER [options]"
  std::string summary;                    // one or two sentences; the help breaks them into lines
  std::vector<std::string*> positionals;  // fields to set; all are required
  Options options;
  std::string instead = {};  // option that replaces the positional argument
};

class Args {
 public:
  // `argv` after the command's name. Sets positionals and options, and the log level (terminal.h).
  Args(const Syntax& syntax, int argc, char** argv);
  // Prints the help or the problem and returns kOk or kUsage; nullopt if the command may run.
  std::optional<int> helpOrProblem() const;

  void complain(const std::string& problem);  // keeps the first non-empty one
  // Complains: NAME must be `form`, not "VALUE".
  void refuse(const std::string& name, const std::string& form);

  // Raw options, for readers and for rules between options.
  bool has(const std::string& name) const { return values_.count(name) > 0; }
  std::string text(const std::string& name, const std::string& otherwise = {}) const;
  std::vector<std::string> texts(const std::string& name) const;  // repeating option
  std::vector<std::string> list(const std::string& name);         // comma-separated, no empty entries
  // nullopt: absent or rejected. `otherwise` is the default that --verbose prints, if it is in the range.
  std::optional<double> number(const std::string& name, double low, double high, bool is_whole,
                               std::optional<double> otherwise);

 private:
  void parse(const Syntax& syntax, int argc, char** argv);
  bool readsLogLevel(const std::string& argument);
  std::string resolved() const;

  std::map<std::string, std::vector<std::string>> values_;  // options given
  mutable std::map<std::string, std::string> resolved_;     // options read, defaults included
  std::vector<std::string> positionals_;
  std::string problem_;
  std::string help_;  // empty: not requested
};

// Readers. Optional fields stay empty if the option is absent.

template <class T>
struct Held {
  using Type = T;
};
template <class T>
struct Held<std::optional<T>> {
  using Type = T;
};

Reader text(std::string& field);
Reader required(std::string& field);
Reader list(std::vector<std::string>& field);
Reader flag(bool& field, bool value = true);

// Converts the option's unit to the field's: number(o.step_m, 0.001, 100, 1e-3) reads millimetres into metres.
template <class T>
Reader number(T& field, double low, double high, double unit = 1) {
  using Number = typename Held<T>::Type;
  return [=, &field](Args& args, const std::string& name) {
    const double per_unit = std::round(1 / unit);  // division yields the double nearest to the decimal number
    std::optional<double> otherwise;
    if constexpr (std::is_same_v<T, Number>) otherwise = unit < 1 ? field * per_unit : field / unit;
    if (const auto value = args.number(name, low, high, std::is_integral_v<Number>, otherwise))
      field = static_cast<Number>(unit < 1 ? *value / per_unit : *value * unit);
  };
}

// Selects one of several words. The message lists them as "one of a, b, c", or with `wording` Or as "a, b or c".
enum class Wording { OneOf, Or };
template <class T>
Reader choice(T& field, std::vector<std::pair<const char*, typename Held<T>::Type>> known,
              Wording wording = Wording::OneOf) {
  return [known = std::move(known), wording, &field](Args& args, const std::string& name) {
    std::string present, form = wording == Wording::OneOf ? "one of " : "";
    for (const auto& [word, value] : known)
      if (field == value) present = word;
    const std::string given = args.text(name, present);
    for (size_t i = 0; i < known.size(); ++i) {
      if (given == known[i].first) return void(field = known[i].second);
      const bool is_last = wording == Wording::Or && i + 1 == known.size();
      form += std::string(i == 0 ? "" : is_last ? " or " : ", ") + known[i].first;
    }
    if (args.has(name)) args.refuse(name, form);
  };
}

// Parses a text with `parse`, which returns nullopt if the text is not of the `form`.
template <class T, class Parse>
Reader parsed(T& field, Parse parse, std::string form) {
  return [=, &field](Args& args, const std::string& name) {
    if (!args.has(name)) return;
    if (auto value = parse(args.text(name)))
      field = *std::move(value);
    else
      args.refuse(name, form);
  };
}

// Parses each comma-separated entry with `parse`.
template <class T, class Parse>
Reader parsedList(std::vector<T>& field, Parse parse, std::string form) {
  return [=, &field](Args& args, const std::string& name) {
    for (const std::string& entry : args.list(name))
      if (auto value = parse(entry))
        field.push_back(*std::move(value));
      else
        args.complain(name + " must be " + form + ", not \"" + entry + "\"");
  };
}

// Parses a size such as "720x960", each side from 1 to `high`.
Reader size(std::optional<std::pair<int, int>>& field, int high);
Reader size(int& width, int& height, int high);

}  // namespace fourdvt::tools
