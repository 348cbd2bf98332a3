#include "kernels/solver/flexible_cg.hpp"

#include <BelosSolverFactory.hpp>
#include <BelosStatusTestCombo.hpp>
#include <BelosStatusTestOutputFactory.hpp>
#include <Teuchos_TimeMonitor.hpp>
#include <array>
#include <cmath>

#include "core/base/process/ranks.hpp"
#include "kernels/mesh/dot.hpp"

namespace cgcontact {

using Teuchos::RCP;
using Teuchos::rcp;

namespace {

/// Returns products of one vector with others, by one sum over all ranks.
template <std::size_t count>
std::array<double, count> ordered_products(const TpetraVector& x,
                                           const std::array<const TpetraVector*, count>& others) {
  const auto local = [](const TpetraVector& v) {
    return Kokkos::subview(v.getLocalViewDevice(Tpetra::Access::ReadOnly), Kokkos::ALL, 0);
  };
  std::array<double, count> sums;
  for (std::size_t k = 0; k < count; ++k)  // by the instance of Tpetra's own vector work
    sums[k] = dot(TpetraVector::execution_space(), local(x), local(*others[k]));
  if (x.getMap()->isDistributed()) sum_over_ranks(sums.data(), count);
  return sums;
}

}  // namespace

double ordered_product(const TpetraVector& x, const TpetraVector& y) { return ordered_products<1>(x, {&y})[0]; }

FlexibleCgIter::FlexibleCgIter(RCP<Problem> problem, RCP<StatusTest> test)
    : problem_(std::move(problem)), test_(std::move(test)) {}

void FlexibleCgIter::setBlockSize(int size) {
  if (size != 1) throw std::invalid_argument("FlexibleCgIter: one right-hand side at a time");
}

void FlexibleCgIter::initialize() {
  const std::vector<int> column = problem_->getLSIndex();
  using Vectors = Belos::MultiVecTraits<double, TpetraVector>;
  residual_ = Vectors::CloneCopy(*problem_->getInitResVec(), column);
  for (RCP<TpetraVector>* v : {&preconditioned_, &direction_, &product_}) *v = Vectors::Clone(*residual_, 1);
  broke_down_ = false;
}

double FlexibleCgIter::residual_norm() const { return std::sqrt(ordered_product(*residual_, *residual_)); }

RCP<const TpetraVector> FlexibleCgIter::getNativeResiduals(std::vector<double>* norms) const {
  if (norms) norms->assign(1, residual_norm());
  return Teuchos::null;
}

void FlexibleCgIter::iterate() {
  if (!isInitialized()) initialize();
  const RCP<TpetraVector> x = problem_->getCurrLHSVec();
  TpetraVector &r = *residual_, &z = *preconditioned_, &p = *direction_, &q = *product_;
  while (test_->checkStatus(this) != Belos::Passed) {
    precondition(r, z);
    p.update(1, z, iterations_ == 0 ? 0 : -ordered_product(z, q) / energy_);
    problem_->applyOp(p, q);
    const auto [energy, slope] = ordered_products<2>(p, {&q, &r});
    energy_ = energy;
    broke_down_ = !(energy_ > 0);
    if (broke_down_) return;
    const double step = slope / energy_;
    x->update(step, p, 1);
    r.update(-step, q, 1);
    ++iterations_;
  }
}

/// z = M r, from the left, the right or both.
void FlexibleCgIter::precondition(const TpetraVector& r, TpetraVector& z) const {
  if (problem_->getLeftPrec().is_null()) return problem_->applyRightPrec(r, z);
  problem_->applyLeftPrec(r, z);
  if (problem_->getRightPrec().is_null()) return;
  const TpetraVector left(z, Teuchos::Copy);
  problem_->applyRightPrec(left, z);
}

FlexibleCgSolMgr::FlexibleCgSolMgr() { setParameters(Teuchos::null); }

RCP<const Teuchos::ParameterList> FlexibleCgSolMgr::getValidParameters() const {
  const auto list = Teuchos::parameterList("FLEXIBLE CG");
  list->set("Convergence Tolerance", static_cast<double>(Belos::DefaultSolverParameters::convTol),
            "of the Euclidean norm of the residual, relative to that of the initial one");
  list->set("Maximum Iterations", 1000, "of each right-hand side");
  list->set("Verbosity", static_cast<int>(Belos::Errors), "sum of Belos::MsgType");
  list->set("Output Style", static_cast<int>(Belos::General), "Belos::OutputType of what the status tests print");
  list->set("Output Frequency", -1, "iterations between two lines of the status tests; -1: only the last");
  list->set("Output Stream", Teuchos::rcpFromRef(std::cout), "where it prints");
  list->set("Timer Label", std::string("Belos"), "begins the name of the timer");
  return list;
}

void FlexibleCgSolMgr::setParameters(const RCP<Teuchos::ParameterList>& parameters) {
  const RCP<Teuchos::ParameterList> now = parameters.is_null() ? Teuchos::parameterList() : parameters;
  now->validateParametersAndSetDefaults(parameters_.is_null() ? *getValidParameters() : *parameters_);
  parameters_ = Teuchos::parameterList(*now);
  printer_ =
      rcp(new Belos::OutputManager<double>(now->get<int>("Verbosity"), now->get<RCP<std::ostream>>("Output Stream")));
  const std::string name = now->get<std::string>("Timer Label") + ": FlexibleCgSolMgr total solve time";
  timer_ = Teuchos::TimeMonitor::lookupCounter(name);
  if (timer_.is_null()) timer_ = Teuchos::TimeMonitor::getNewCounter(name);
}

void FlexibleCgSolMgr::reset(Belos::ResetType type) {
  if ((type & Belos::Problem) && !problem_.is_null()) problem_->setProblem();
}

Belos::ReturnType FlexibleCgSolMgr::solve() {
  if (problem_.is_null() || !problem_->isProblemSet())
    throw std::invalid_argument("FlexibleCgSolMgr: the linear problem is not set");
  const Teuchos::TimeMonitor timing(*timer_);
  iterations_ = 0;
  achieved_ = 0;
  bool converged = true;
  for (int column = 0; column < static_cast<int>(problem_->getRHS()->getNumVectors()); ++column)
    converged = solve_column(column) && converged;
  if (printer_->isVerbosity(Belos::TimingDetails))
    Teuchos::TimeMonitor::summarize(printer_->stream(Belos::TimingDetails));
  return converged ? Belos::Converged : Belos::Unconverged;
}

bool FlexibleCgSolMgr::solve_column(int column) {
  using Combination = Belos::StatusTestCombo<double, TpetraVector, TpetraOperator>;
  using OutputFactory = Belos::StatusTestOutputFactory<double, TpetraVector, TpetraOperator>;
  problem_->setLSIndex({column});
  const auto most = rcp(new MaxIters(parameters_->get<int>("Maximum Iterations")));
  const auto residual = rcp(new ResidualNorm(parameters_->get<double>("Convergence Tolerance")));
  const auto output =
      OutputFactory(parameters_->get<int>("Output Style"))
          .create(printer_, rcp(new Combination(Combination::OR, most, residual)),
                  parameters_->get<int>("Output Frequency"), Belos::Passed + Belos::Failed + Belos::Undefined);
  output->setSolverDesc(" Flexible CG ");
  FlexibleCgIter iteration(problem_, output);
  iteration.initialize();
  const double initial = iteration.residual_norm();
  residual->defineScaleForm(Belos::UserProvided, Belos::TwoNorm, initial);
  bool converged = initial == 0;
  if (!converged) {
    iteration.iterate();
    converged = residual->getStatus() == Belos::Passed;
    achieved_ = std::max(achieved_, iteration.residual_norm() / initial);
    output->print(printer_->stream(Belos::FinalSummary));
  }
  iterations_ += iteration.getNumIters();
  problem_->setCurrLS();
  return converged;
}

void register_flexible_cg() {
  using Factory = Belos::SolverFactory<double, TpetraVector, TpetraOperator>;
  static const bool once = [] {
    if (!Factory::isSolverRegistered("FLEXIBLE CG")) Factory::registerSolver("FLEXIBLE CG", rcp(new FlexibleCgSolMgr));
    return true;
  }();
  (void)once;
}

}  // namespace cgcontact
