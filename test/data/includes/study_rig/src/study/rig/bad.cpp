#include "study/charts/node_costs.h"
