// SPDX-License-Identifier: Apache-2.0
// Parameters of classes ("speed_mps"): the values that are wanted, by name, whatever is played; and the values that one
// track shows, which glide to the wanted ones, with the blend weights that follow from them. Does NOT blend meshes.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "motion/parameter_space.h"

namespace fourdvt {

class Parameters {
 public:
  explicit Parameters(double rate) : rate_(rate) {}
  void set(const std::string& name, double value) { wanted_[name] = value; }
  // Of a class's parameter: as set, else as of its first member; within its range.
  double wanted(const package::Sequence& sequence, size_t parameter) const;
  double rate() const { return rate_; }  // a shown value crosses its whole range at most this often a second

 private:
  std::map<std::string, double> wanted_;
  double rate_;
};

// The parameter values whose weights are nearest to these; none: the sequence has no parameters.
std::vector<double> parametersAt(const package::Sequence& sequence, const std::vector<float>& weights);

class ShownParameters {
 public:
  // The next `enter` begins at these values instead of the wanted ones; none: at the wanted ones.
  void setEntry(std::vector<double> values) { entry_ = std::move(values); }
  bool hasEntry() const { return !entry_.empty(); }
  void enter(const package::Sequence& sequence, const Parameters& parameters);  // another sequence is shown from now on
  // A step of `dt_s` towards the wanted values. True: the weights changed.
  bool glide(const package::Sequence& sequence, const Parameters& parameters, double dt_s);
  double value(size_t parameter) const { return values_[parameter]; }
  const motion::BlendWeights& weights() const { return weights_; }

 private:
  std::vector<double> values_;  // of the shown sequence's parameters
  std::vector<double> entry_;
  motion::BlendWeights weights_;
};

}  // namespace fourdvt
