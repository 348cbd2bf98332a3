#include "contact/solve/forces/preload.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "contact/model/opposite_points.hpp"

namespace cgcontact {
namespace {

/// Relative tolerance of the prescribed force; the outer iteration converges to about that.
constexpr double preload_tolerance = 1e-6;
/// The force is piecewise linear in the interference: a few solves, unless it does not follow it at all.
constexpr int max_solves = 25;
/// Growth of a pair's steps without a force until its faces meet; with one, largest ratio of a step to the tightening
/// (zones that grow with the force are stiffer then).
constexpr double growth = 4;

/// Returns a first guess of the stiffness, N/m: two columns of a length below the area of the pair.
double guessed_stiffness(const std::vector<BodyModel>& bodies, const ContactPair& pair, double length) {
  double area = 0, compliance = 0;
  for (const ContactGroup& group : pair.groups) area += group.area;
  for (const int b : {pair.primary, pair.secondary}) compliance += 1 / bodies[b].spec->material.youngs_modulus;
  return bodies[pair.primary].slices * area / (compliance * length);
}

}  // namespace

Preload::Preload(const Scene& scene) {
  for (const ContactSpec& contact : scene.contacts)
    if (contact.preload) tightened_.push_back(&contact);
  const auto size = static_cast<Eigen::Index>(tightened_.size());
  tightening_ = step_ = last_force_ = longest_ = Eigen::VectorXd::Zero(size);
  stiffness_ = Eigen::MatrixXd::Zero(size, size);
}

double Preload::tightening(const ContactPair& pair) const {
  const auto found = std::find(tightened_.begin(), tightened_.end(), pair.spec);
  return found == tightened_.end() ? 0 : tightening_[found - tightened_.begin()];
}

void Preload::start_from(const Preload& earlier) {
  tightening_ = earlier.tightening_;
  stiffness_ = earlier.stiffness_;
  guessed_ = false;
}

void Preload::begin(const std::vector<BodyModel>& bodies, const std::vector<ContactPair>& pairs) {
  for (Eigen::Index i = 0; i < tightening_.size(); ++i)
    for (const ContactPair& pair : pairs) {
      if (pair.spec != tightened_[i]) continue;
      longest_[i] = std::min(longest_extent(bodies[pair.primary]), longest_extent(bodies[pair.secondary]));
      if (!guessed_) continue;
      stiffness_(i, i) = guessed_stiffness(bodies, pair, longest_[i]);
      tightening_[i] = *pair.spec->preload / stiffness_(i, i);
    }
}

void Preload::refuse(Eigen::Index pair, double force) const {
  const ContactSpec& spec = *tightened_[pair];
  throw InputError(
      spec.location, '"' + spec.name + '"',
      fmt::format("its preload of {:.6g} N is not reached: after {} solves an interference of {:.4g} m gives {:.6g} N",
                  *spec.preload, solves_, spec.interference + tightening_[pair], force),
      "a pair whose force its interference gives, not the loads alone, within small strain");
}

bool Preload::tighten(const std::vector<ContactPair>& pairs, const std::vector<double>& forces) {
  const Eigen::Index size = tightening_.size();
  Eigen::VectorXd force = Eigen::VectorXd::Zero(size), missing(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (std::size_t k = 0; k < pairs.size(); ++k)
      if (pairs[k].spec == tightened_[i]) force[i] += forces[k];
    missing[i] = *tightened_[i]->preload - force[i];
  }
  Eigen::Index worst = 0;
  for (Eigen::Index i = 0; i < size; ++i)
    if (std::abs(missing[i]) / *tightened_[i]->preload > std::abs(missing[worst]) / *tightened_[worst]->preload)
      worst = i;
  if (std::abs(missing[worst]) <= preload_tolerance * *tightened_[worst]->preload) return false;
  if (++solves_ == max_solves) refuse(worst, force[worst]);
  if (guessed_ && solves_ == 1)  // in proportion, where the faces just touch without it
    for (Eigen::Index i = 0; i < size; ++i)
      if (force[i] > 0 && tightening_[i] > 0) stiffness_(i, i) = force[i] / tightening_[i];
  if (step_.squaredNorm() > 0 && (force.array() > 0).all() && (last_force_.array() > 0).all())
    stiffness_ += (force - last_force_ - stiffness_ * step_) * step_.transpose() / step_.squaredNorm();
  const Eigen::VectorXd last_step = step_;
  step_ = stiffness_.partialPivLu().solve(missing);
  for (Eigen::Index i = 0; i < size; ++i) {
    if (!(force[i] > 0)) step_[i] = std::max(missing[i] / stiffness_(i, i), growth * last_step[i]);
    if (force[i] > 0 && tightening_[i] > 0) step_[i] = std::min(step_[i], growth * tightening_[i]);
  }
  for (Eigen::Index i = 0; i < size; ++i)
    if (!(std::abs(tightened_[i]->interference + tightening_[i] + step_[i]) < longest_[i])) refuse(i, force[i]);
  last_force_ = force;
  tightening_ += step_;
  return true;
}

}  // namespace cgcontact
