void read(const YamlNode& scene) { scene.child("body"); }
