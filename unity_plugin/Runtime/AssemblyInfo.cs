using System.Runtime.CompilerServices;

[assembly: InternalsVisibleTo("Anthronet.Editor")]
[assembly: InternalsVisibleTo("Anthronet.Tests")]
[assembly: InternalsVisibleTo("Anthronet.Editor.Tests")]
