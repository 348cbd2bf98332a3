/// Vector operations of the conjugate gradients, as Belos does them on Tpetra's vectors. Sizes are thousands of DoFs.
#include <Tpetra_Core.hpp>
#include <cmath>
#include <memory>

#include "kernels/operator/operator.hpp"
#include "perf/harness.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;

/// Vectors of one CG solve; x, r, z, p start with fixed values.
struct Vectors {
  int size;
  TpetraVector x, r, z, p, q;

  explicit Vectors(int thousands) : Vectors(1000 * thousands, make_map(1000 * thousands)) {}

 private:
  Vectors(int n, const Teuchos::RCP<const TpetraMap>& map)
      : size(n), x(map, 1), r(map, 1), z(map, 1), p(map, 1), q(map, 1) {
    double shift = 0;
    for (TpetraVector* v : {&x, &r, &z, &p, &q}) {
      auto view = v->getLocalViewHost(Tpetra::Access::OverwriteAll);
      for (int i = 0; i < n; ++i) view(i, 0) = std::sin(1.7 * i + shift);
      shift += 1;
    }
  }
  static Teuchos::RCP<const TpetraMap> make_map(int n) {
    return Teuchos::rcp(new TpetraMap(static_cast<Tpetra::global_size_t>(n), 0, Tpetra::getDefaultComm()));
  }
};

double plain_dot(const TpetraVector& a, const TpetraVector& b) {
  const auto u = a.getLocalViewHost(Tpetra::Access::ReadOnly), v = b.getLocalViewHost(Tpetra::Access::ReadOnly);
  double sum = 0;
  for (std::size_t i = 0; i < u.extent(0); ++i) sum += u(i, 0) * v(i, 0);
  return sum;
}

double dot(const TpetraVector& a, const TpetraVector& b) {
  double result = 0;
  a.dot(b, Teuchos::ArrayView<double>(&result, 1));
  return result;
}

/// a . b: one multiply-add per entry, two entries read.
Kernel make_dot(int size) {
  auto v = std::make_shared<Vectors>(size);
  const double scale = std::sqrt(plain_dot(v->x, v->x) * plain_dot(v->r, v->r));
  Kernel k;
  k.items = v->size;
  k.cost = {2.0 * v->size, 16.0 * v->size};
  k.error = std::abs(dot(v->x, v->r) - plain_dot(v->x, v->r)) / scale, k.tolerance = 1e-13, k.against = "a plain loop";
  k.run = [v] { benchmark::DoNotOptimize(dot(v->x, v->r)); };
  return k;
}

/// x += a p: one multiply-add per entry; x and p read, x written.
Kernel make_axpy(int size) {
  auto v = std::make_shared<Vectors>(size);
  const double a = 0.25;
  double error = 0;
  {
    TpetraVector expected(v->x, Teuchos::Copy);
    v->x.update(a, v->p, 1);
    const auto e = expected.getLocalViewHost(Tpetra::Access::ReadWrite);
    const auto x = v->x.getLocalViewHost(Tpetra::Access::ReadOnly), p = v->p.getLocalViewHost(Tpetra::Access::ReadOnly);
    for (int i = 0; i < v->size; ++i) error = std::max(error, std::abs(e(i, 0) + a * p(i, 0) - x(i, 0)));
  }
  Kernel k;
  k.items = v->size;
  k.cost = {2.0 * v->size, 24.0 * v->size};
  k.error = error, k.tolerance = 1e-15, k.against = "a plain loop";
  k.run = [v, sign = std::make_shared<double>(a)] { v->x.update(*sign = -*sign, v->p, 1); };
  return k;
}

/// All vector work of one iteration of Belos' CG: p . q, x += alpha p, r -= alpha q, |r|, r . z, p = z + beta p.
/// Three updates (72 bytes and 6 flop per entry; no write-allocate, as every result is read as well), two products (32
/// and 4), a norm (8 and 2).
struct CgStep {
  static constexpr double flop = 12, bytes = 112;
  static double run(Vectors& v, double alpha, double beta) {
    double norm = 0;
    const double pq = dot(v.p, v.q);
    v.x.update(alpha, v.p, 1);
    v.r.update(-alpha, v.q, 1);
    v.r.norm2(Teuchos::ArrayView<double>(&norm, 1));
    const double rz = dot(v.r, v.z);
    v.p.update(1, v.z, beta);
    return pq + norm + rz;
  }
  static double plain(Vectors& v, double alpha, double beta) {
    const double pq = plain_dot(v.p, v.q);
    {
      const auto x = v.x.getLocalViewHost(Tpetra::Access::ReadWrite),
                 r = v.r.getLocalViewHost(Tpetra::Access::ReadWrite);
      const auto p = v.p.getLocalViewHost(Tpetra::Access::ReadWrite);
      const auto q = v.q.getLocalViewHost(Tpetra::Access::ReadOnly), z = v.z.getLocalViewHost(Tpetra::Access::ReadOnly);
      for (int i = 0; i < v.size; ++i) {
        x(i, 0) += alpha * p(i, 0);
        r(i, 0) -= alpha * q(i, 0);
        p(i, 0) = z(i, 0) + beta * p(i, 0);
      }
    }
    return pq + std::sqrt(plain_dot(v.r, v.r)) + plain_dot(v.r, v.z);
  }
};

Kernel make_cg_step(int size) {
  auto v = std::make_shared<Vectors>(size);
  Vectors plain(size);
  double error = 0;
  for (int step = 0; step < 2; ++step) {
    const double a = CgStep::run(*v, 0.5, 0.25), b = CgStep::plain(plain, 0.5, 0.25);
    error = std::max(error, std::abs(a - b) / v->size);
  }
  Kernel k;
  k.items = v->size;
  k.cost = {CgStep::flop * v->size, CgStep::bytes * v->size};
  k.error = error, k.tolerance = 1e-13, k.against = "plain loops";
  k.run = [v] { benchmark::DoNotOptimize(CgStep::run(*v, 1e-9, 0.25)); };
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    add("vectors/dot", make_dot, {{2}, {8000}});
    add("vectors/axpy", make_axpy, {{2}, {8000}});
    add("vectors/cg_step", make_cg_step, {{2}, {8000}});
  });
}
