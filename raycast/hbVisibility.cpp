#include "raycast/hbVisibility.h"

// Tables blend entries one cell apart; another cell for the rounding of values and places.
hbVisibility::hbVisibility(const hbTransferFunction& function, const hbMatter& matter)
    : opacities_(function), map_(matter.map()), margin_(2.0 * matter.cell()),
      showsNaN_(function.definition().nanOpacity > 0.0) {}
