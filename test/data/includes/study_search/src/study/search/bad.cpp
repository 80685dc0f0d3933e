#include "study/robust/random_robots.h"
