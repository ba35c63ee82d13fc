#include "shared/model/camera.hpp"
namespace fleetloc {}
