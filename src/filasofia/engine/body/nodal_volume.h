#pragma once

#include "filasofia/engine/body/soft_model.h"

/// The volumes of nodes, by which nearly incompressible tissue keeps its volume without locking (average nodal
/// pressure: Bonet and Burton 1998). Elements have too few degrees of freedom to keep their volumes one by one; a node
/// shares the mean change of volume of the elements around it. The energy is that of every element's law with
/// kSharedPoisson (lameOf), which also stabilises the pressure (Puso and Solberg 2006), and
///
///     W = sum over nodes of k_n / 2 theta_n^2,   k_n = sum k_e,   theta_n = sum k_e (J_e - 1) / k_n
///
///     k_e      [J] a quarter of nodalBulk times the volume of an element; the sums run over the elements around a node
///     J_e      [-] det F of an element
///     theta_n  [-] change of the node's volume
///
/// Elements that are compressible take no part: k_e is zero.
namespace filasofia::engine {

/// k_e [J].
inline double nodalShare(const FemElement& element) { return 0.25 * nodalBulk(element) * element.volume; }

/// Whether some element has such a share.
bool hasNodalVolumes(const std::vector<FemElement>& elements);

/// theta_n [-] per node, right for a node if the elements listed are all around it. Empty if no element of the body has
/// a share.
std::vector<double> volumeChanges(const SoftModel& model, const std::vector<Vec3>& x, std::span<const int> elements);
/// The same of all nodes.
std::vector<double> volumeChanges(const SoftModel& model, const std::vector<Vec3>& x);
/// The rates of theta_n [1/s], in the same way.
std::vector<double> volumeRates(const SoftModel& model, const SoftState& state, std::span<const int> elements);

/// [Pa] What the volumes of its nodes add to the Cauchy stress of an element in every direction, tension positive; with
/// rates, its rate. 0 if `changes` is empty.
double nodalTension(const FemElement& element, std::span<const double> changes);

/// [1/m] d(J_e)/dx of the four nodes: cof(F) g_i.
Corners volumeGradients(const FemElement& element, const Mat3& f);

} // namespace filasofia::engine
