// The control random-places: it changes a body as much as the operators would, but at random places.
#pragma once

#include "evodevo/helpers/chance.hpp"
#include "life/edits.hpp"

namespace evodevo {

/// How much an operator changed in one application, regardless of where in the body. It has no indices of masses or
/// springs, so it can be applied to any body.
struct Amount {
  struct SpringKind {
    Material material;
    double stiffness_factor = 1;
  };
  struct SpringChange {
    SpringKind before;
    std::optional<double> length;            ///< new rest length relative to the old one, 1; none: it stays the same
    std::optional<Material> material;        ///< new material; none: it stays the same
    std::optional<double> stiffness_factor;  ///< new one; none: it stays the same
  };
  struct MassCome {
    double mass;  ///< kg
    std::optional<Material> material;
  };
  struct SpringCome {
    SpringKind kind;
    std::optional<std::uint32_t> a, b;  ///< index into `masses_come` of each end; none: any mass that stays
  };

  std::uint32_t op = 0;                              ///< index into the experiment's devo operators
  std::optional<Scaling> scaling;                    ///< of all rest lengths
  std::vector<SpringKind> springs_gone;              ///< removed springs and springs of removed masses
  std::vector<std::optional<Material>> masses_gone;  ///< materials of removed masses; nullopt for no material
  std::vector<SpringChange> springs_changed;
  std::vector<MassCome> masses_come;
  std::vector<SpringCome> springs_come;
};

/// Returns how much the `edits` of operator `op` change in `body`.
Amount amount_of(const Edits& edits, const Body& body, std::uint32_t op);

/// Returns edits that make the same amount of change at random places:
///
/// - For each removed or changed spring of `amount`, one of the same material and stiffness factor is drawn at random,
///   or, if none is left, one of any kind; likewise for each removed mass, one of the same material. Rest lengths
///   change by the same factors.
/// - A new mass is placed at random within the bounds. It has the material given in `amount`, or no material if the
///   body does not have that one.
/// - A new spring joins two random masses that stay and are not joined yet. An end that is at a new mass in `amount` is
///   at the corresponding new mass here. The spring exerts no force at first. If no free pair is found, the spring is
///   left out.
/// - A change of all rest lengths by one rule stays the same.
///
/// With inherited draws, all of this follows from the identities of masses, so that the places are as much inherited as
/// those that the operators choose.
///
/// The springs of a removed mass count as removed springs. `surplus` is the number of springs that have been removed in
/// this way beyond the amounts, now and at earlier applications. To compensate, that many fewer springs are removed as
/// soon as possible. Limits that an operator observes, such as those on the degree of masses, do not apply here.
Edits at_random_places(const Amount& amount, const DevoContext& context, std::size_t& surplus, Chance& chance);

/// The amounts of change in one life. A second life with the same start is yoked to it: at each application, the second
/// life is changed by the same amounts.
class Yoke {
 public:
  Yoke(LivingBody born, const LifeRecord& record) : living_(std::move(born)), changes_(record.changes()) {}

  /// Returns the amounts that the operators changed after a cycle. To be called for each cycle in ascending order.
  /// Pieces that were torn off do not count. Amounts with removed masses come first: if too many springs are removed
  /// together with these masses, the other amounts compensate for that in the same cycle.
  std::vector<Amount> amounts_after(int cycle);

  std::size_t surplus = 0;  ///< surplus of the second life; see at_random_places()

 private:
  LivingBody living_;
  std::vector<Change> changes_;
  std::size_t next_ = 0;  ///< index into `changes_`
};

}  // namespace evodevo
