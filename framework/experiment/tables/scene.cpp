#include "experiment/tables/declarations.hpp"
#include "experiment/tables/tables.hpp"

namespace evodevo {

void read_scene(TomlReader& top, Settings& settings) {
  read_table(top, "scene", false, [&](TomlReader& scene) {
    scene.expect({"gravity", "floor", "friction", "damping", "drag", "payload"});
    for_each_force(settings, [&](std::string_view name, auto& force) {
      read_table(scene, name, false, [&](TomlReader& t) { declare(t, force.emplace()); });
    });
    if (settings.scene.friction && !settings.scene.floor)
      scene.fail("friction", "there is no floor for friction to act on; add [scene.floor] or remove [scene.friction]");
  });
}

}  // namespace evodevo
