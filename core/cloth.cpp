#include <nuno/cloth.h>

#include <cmath>

namespace nuno {

Chain make_chain(const Points& initial, const ChainMaterial& material, double gravity) {
  const Index n = initial.cols();
  const auto particles = static_cast<double>(n);
  Chain chain;
  chain.initial = initial;
  chain.relative_mass = Vector::Ones(n);
  chain.particle_mass = material.mass / particles;
  chain.drag_rate = material.air_drag / particles / chain.particle_mass;
  chain.gravity = gravity;
  chain.edges.resize(2, n - 1);
  for (Index i = 0; i + 1 < n; ++i) chain.edges.col(i) << i, i + 1;
  chain.rest_length = segment_lengths(initial);
  chain.size = chain.rest_length.sum();
  chain.sound_speed = std::sqrt(material.stretch_stiffness * chain.size / material.mass);
  chain.hinge_length = 0.5 * (chain.rest_length.head(n - 2) + chain.rest_length.tail(n - 2));
  chain.material = material;
  return chain;
}

}  // namespace nuno
