// Controls: what a developing body is compared with.
#pragma once

#include "life/life_record.hpp"

namespace evodevo {

/// What an operator changed at one application, but for where. All indices are gone, so that it holds for any body.
struct Amount {
  struct SpringChange {
    Material before;
    std::optional<double> factor;   ///< of the rest length, 1; without it, that stays
    std::optional<Material> after;  ///< without it, that of before
  };
  struct MassCome {
    double mass;  ///< kg
    std::optional<Material> material;
  };
  struct SpringCome {
    Material material;
    std::optional<std::uint32_t> a, b;  ///< index into `masses_come`; without it, any mass that stays
  };

  std::uint32_t op = 0;                              ///< place in Development::operators
  std::optional<Growth> growth;                      ///< of all springs
  std::vector<Material> springs_gone;                ///< one for each, whether it went by itself or with a mass
  std::vector<std::optional<Material>> masses_gone;  ///< one for each
  std::vector<SpringChange> springs_changed;
  std::vector<MassCome> masses_come;
  std::vector<SpringCome> springs_come;
};

/// How much `edits` of operator `op` change in `body`.
Amount amount_of(const Edits& edits, const Body& body, std::uint32_t op);

/// The same amount of change at random places. Springs and masses go, and springs change by the same factors, that are
/// of the material of those that did, or of any where none is left. New springs join random masses that stay and are
/// not yet joined, and are born without force; a new mass comes anywhere in the bounds and gets as many springs. The
/// springs of a mass that goes count among those that go. `surplus` is how many more have gone so than should have,
/// now and at earlier applications; as many fewer go as soon as that is possible. A new mass of a material that the
/// body does not know has none. Fewer come where the body has no room for more. Growth has no place and happens as it
/// is. Bounds that an operator keeps do not hold here.
Edits at_random_places(const Amount& amount, const DevoContext& context, std::size_t& surplus, Rng& rng);

/// What happened in a life, for another one of the same start that is to change as much at each application.
class Yoke {
 public:
  Yoke(Body born, const LifeRecord& record) : body_(std::move(born)), changes_(record.changes()) {}

  /// What the operators changed after a cycle; to be asked for one cycle after the other. What the body lost because it
  /// was torn is not among it. Turns at which masses went come first: where more springs go with masses than should,
  /// the others then make up for it in the same cycle.
  std::vector<Amount> amounts_after(int cycle);

  std::size_t surplus = 0;  ///< of the life that follows; see at_random_places()

 private:
  Body body_;
  std::vector<Change> changes_;
  std::size_t next_ = 0;  ///< index into `changes_`
};

}  // namespace evodevo
