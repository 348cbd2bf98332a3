/// Data of the outer iteration.
#pragma once

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

/// The arguments must outlive this object. The iteration sets the state of the contact points, the rest position of
/// springs that follow a motion, and the stiffness of the system's groups.
struct OuterProblem {
  const Scene& scene;
  std::vector<BodyModel>& bodies;
  std::vector<ContactPair>& pairs;
  std::vector<SupportPoint>& supports;
  ElasticSystem& system;
  const Scales& scales;
  ExecSpace exec;  ///< what kernels run on
};

}  // namespace cgcontact
