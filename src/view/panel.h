// The panel and what else lies over the image: list of keys, pick, inspector, messages.
#pragma once

#include "view/gui.h"
#include "view/model.h"

namespace glint::view {

// Width in pixels of a docked panel in a window of this width: half of it at most.
int dockWidth(const Gui& gui, int window);

// Draws all of it, between Gui::begin and Gui::end. Changes the model; Model::wish holds what a button asks
// for.
void drawPanel(Gui& gui, Model& model);

}  // namespace glint::view
