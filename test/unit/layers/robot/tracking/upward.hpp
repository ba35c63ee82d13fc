// Not part of any program: the layer check must refuse this file.
#include "deploy/sim/world/scene.hpp"
