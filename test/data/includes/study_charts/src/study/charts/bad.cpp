#include "study/rig/lab_settings.h"
