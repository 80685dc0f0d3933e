#include "study/experiment.h"
