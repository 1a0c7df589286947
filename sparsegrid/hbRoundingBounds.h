#pragma once

#include <glm/vec3.hpp>

#include "sparsegrid/hbCombinationSparseGrid.h"
#include "sparsegrid/hbSparseGrid.h"

/// How far the ways to evaluate a sparse grid in 32 bits may be from the function that its stored surpluses stand for,
/// wherever in the cube: derived in doc/sparse-grids.md, in field values. O(stored values) each.
namespace hb {

/// Sum over the subspaces of the largest surplus: no partial sum of an evaluation exceeds it, as the weights of the
/// basis functions of one subspace sum to at most 1.
double amplitude(const hbSparseGrid& grid, int component = 0);

/// Sum of the magnitudes of the combination's coefficients: how much larger than the values its terms are together.
double amplification(const hbIndexSet& set);
double amplification(const hbCombinationSparseGrid& grid);

/// The greatest slopes there may be along the axes of the cube, per unit of its edges: of a subspace, 2^l times its
/// largest surplus; of level 0, the difference of two.
glm::dvec3 slopeBounds(const hbSparseGrid& grid, int component = 0);

/// With the aligned mapping, the lattice coordinate of a point is rounded to 32 bits, by 2^-25 at most, before the
/// weights are taken; they change by the slope 2^l of their hats. 0 with the fitted mapping: the coordinates are the
/// points' own.
double coordinateBound(const hbSparseGrid& grid, int component = 0);

/// How often each way rounds what no partial sum exceeds, by half a unit in the last place or 2^-24 of it.
///
/// direct: three weights and their two products, the product with the surplus, the surplus itself, and the additions
/// over lx; the rest is in 64 bits; once more at the end.
double directRoundings(const hbIndexSet& set);
/// seminodal: the stored value; the weights of y and z, their product and that with the value; the additions of the
/// lines of one length; the weight of x and its product; the additions over the lengths; the sum of the two nodes along
/// x.
double semiNodalRoundings(const hbIndexSet& set);
/// lattice, see hbLatticeEvaluator; `row` is the axis along which rows follow each other. An interpolation
/// (1 - t) a + t b rounds t (which moves the result by twice a rounding, as b - a is up to twice the amplitude), 1 - t,
/// the two products (together one) and their sum: 5. A coarse row: its line and an interpolation between the line's
/// nodes. Each level of the row axis adds a mean and a sum, then there is an interpolation between two coarse rows. The
/// table: its hierarchical values, the products with their weights and 16 additions, then an interpolation. Each part
/// is that of its own share of the amplitude; in the end they are added.
double latticeRoundings(const hbIndexSet& set, int row = 1);
/// combination: the nodal value; in each of three lerps a + t (b - a) a difference and a product of up to twice the
/// largest nodal value and a sum of up to once that, so 5; the coefficient, where it is no integer; the product with
/// it, and the result. Of each term.
constexpr double kCombinationRoundings = 19.0;

double directBound(const hbSparseGrid& grid, int component = 0);
double semiNodalBound(const hbSparseGrid& grid, int component = 0);
/// Its coordinates are in 64 bits.
double latticeBound(const hbSparseGrid& grid, int row = 1, int component = 0);
/// `largest`: nodal value. The coordinates' rounding comes on top (coordinateBound).
double combinationBound(const hbIndexSet& set, double largest);
/// The same for any coefficients.
double combinationBound(const hbCombinationSparseGrid& grid, double largest);

} // namespace hb
