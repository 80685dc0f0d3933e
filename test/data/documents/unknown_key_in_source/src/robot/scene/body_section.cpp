void read(const YamlNode& scene) { scene.number_or("gravity_m_s2", 0); }
