using UnityEditor;

namespace Anthronet.Editor
{
    /// <summary>Inspector of a request asset.</summary>
    [CustomEditor(typeof(AnthroRequestAsset))]
    public sealed class AnthroRequestAssetEditor : UnityEditor.Editor
    {
        readonly AnthroRequestGui gui = new AnthroRequestGui();

        /// <inheritdoc/>
        public override void OnInspectorGUI()
        {
            serializedObject.Update();
            AnthroRequestGui.DrawWithLibrary(() => gui.Draw(serializedObject.FindProperty("request"), null));
            serializedObject.ApplyModifiedProperties();
        }
    }
}
