#include "kernels/operator/operator.hpp"

namespace cgcontact {

void ElasticityOperator::apply(const TpetraVector& X, TpetraVector& Y, Teuchos::ETransp, double alpha,
                               double beta) const {
  const ExecSpace exec;
  const auto x_all = X.getLocalViewDevice(Tpetra::Access::ReadOnly);
  const auto y_all =
      beta == 0 ? Y.getLocalViewDevice(Tpetra::Access::OverwriteAll) : Y.getLocalViewDevice(Tpetra::Access::ReadWrite);
  const int n = operator_.num_dofs();
  for (std::size_t column = 0; column < X.getNumVectors(); ++column) {
    const RealView y(y_all.data() + column * y_all.stride(1), n);
    const Kokkos::View<const double*, MemSpace> x(x_all.data() + column * x_all.stride(1), n);
    if (alpha == 1 && beta == 0) {
      operator_.apply(exec, x, y);
      continue;
    }
    const RealView product(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::operator::product"), n);
    operator_.apply(exec, x, product);
    Kokkos::parallel_for(
        "cgcontact::operator::combine", Kokkos::RangePolicy<ExecSpace>(exec, 0, n),
        KOKKOS_LAMBDA(const int i) { y(i) = alpha * product(i) + (beta == 0 ? 0.0 : beta * y(i)); });
  }
}

}  // namespace cgcontact
